// An application with a scene of its own that shows the room while it is being reconstructed:
//   renderer SEQUENCE --out FOLDER [--frames N]     a PNG for every tenth frame
//   renderer SEQUENCE --window [--frames N]         where it was built with GLFW
// It uses the public headers; the sequence stands for a camera.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "apps/renderer/compositor.h"
#include "apps/renderer/window.h"
#include "host/datasets/sequence.h"

namespace {

using renderer::Vertex;

constexpr int kEvery = 10;  // frames per PNG

struct Arguments {
  std::string sequence, out;
  std::size_t frames = ~std::size_t(0);
  bool window = false;
};

Arguments parse(int count, char** texts) {
  const auto usage = [] {
    throw std::runtime_error("Usage: renderer SEQUENCE (--out FOLDER | --window) [--frames N]");
  };
  Arguments out;
  for (int i = 1; i < count; ++i) {
    const std::string text = texts[i];
    if (text == "--window")
      out.window = true;
    else if (text == "--out" && i + 1 < count)
      out.out = texts[++i];
    else if (text == "--frames" && i + 1 < count)
      out.frames = std::strtoul(texts[++i], nullptr, 10);
    else if (out.sequence.empty() && text[0] != '-')
      out.sequence = text;
    else
      usage();
  }
  if (out.sequence.empty() || out.window == !out.out.empty()) usage();
  return out;
}

/// Median of the frame's valid depths, metres; 1 without any.
float middleDepth(const rosefusion::Frame& frame, double units_per_metre) {
  std::vector<std::uint16_t> depths;
  for (const std::uint16_t depth : cv::Mat_<std::uint16_t>(frame.depth))
    if (depth) depths.push_back(depth);
  if (depths.empty()) return 1;
  std::nth_element(depths.begin(), depths.begin() + depths.size() / 2, depths.end());
  return static_cast<float>(depths[depths.size() / 2] / units_per_metre);
}

/// An octahedron before the first camera, at the depth of what the camera sees: in part before it, in part
/// behind.
std::vector<Vertex> scene(float depth) {
  const float r = 0.3f * depth;
  const std::array<float, 3> tips[6] = {{r, 0, depth},  {-r, 0, depth},    {0, r, depth},
                                        {0, -r, depth}, {0, 0, depth + r}, {0, 0, depth - r}};
  std::vector<Vertex> triangles;
  for (int face = 0; face < 8; ++face) {
    const std::array<float, 3> colour = {face & 1 ? 0.95f : 0.75f, face & 2 ? 0.45f : 0.3f,
                                         face & 4 ? 0.2f : 0.1f};
    for (int axis = 0; axis < 3; ++axis) triangles.push_back({tips[2 * axis + (face >> axis & 1)], colour});
  }
  return triangles;
}

void writePng(const renderer::Compositor& compositor, const std::filesystem::path& file) {
  const auto [width, height] = compositor.size();
  cv::Mat picture(static_cast<int>(height), static_cast<int>(width), CV_8UC3);
  for (std::size_t i = 0; i < picture.total(); ++i) {
    const std::uint32_t w = compositor.read()[i];
    picture.ptr<cv::Vec3b>()[i] = {std::uint8_t(w >> 16), std::uint8_t(w >> 8), std::uint8_t(w)};
  }
  if (!cv::imwrite(file.string(), picture)) throw std::runtime_error(file.string() + " cannot be written.");
}

int run(const Arguments& arguments) {
  const auto sequence = rosefusion::openSequence(arguments.sequence);
  const rosefusion::Intrinsics& k = sequence->info().intrinsics;
  const rosefusion::Camera camera{
      k.width, k.height, k.fx, std::abs(k.fy), k.cx, k.cy, sequence->info().depth_units_per_metre};
  renderer::ApplicationOptions options{.validation = std::getenv("RENDERER_VALIDATION") != nullptr,
                                       .instance_extensions = {},
                                       .swapchain = arguments.window};
  if (arguments.window) options.instance_extensions = renderer::windowExtensions();
  renderer::Application application(options);
  rosefusion::Reconstructor reconstructor(camera, application.handles());
  rosefusion::Frame frame;
  std::string problem;
  if (!sequence->read(0, frame, problem)) throw std::runtime_error(problem);
  renderer::Compositor compositor(application, reconstructor, camera,
                                  scene(middleDepth(frame, camera.depth_units_per_metre)));
  std::unique_ptr<renderer::Window> window;
  if (arguments.window)
    window = std::make_unique<renderer::Window>(application, compositor.size());
  else
    std::filesystem::create_directories(arguments.out);

  rosefusion::Matrix pose = rosefusion::kIdentity;
  std::size_t done = 0;
  const std::size_t frames = std::min(arguments.frames, sequence->size());
  const auto draw = [&] {
    const VkCommandBuffer commands = application.beginFrame();
    compositor.draw(commands, pose);
    if (window)
      window->present(commands, compositor.picture());
    else
      application.endFrame();
  };
  const auto take = [&] {
    while (const auto result = reconstructor.poll()) {
      ++done;
      pose = result->world_from_camera;
      if (result->status == rosefusion::Status::Lost)
        std::printf("%.3f s: lost, %s\n", result->timestamp, result->reason.c_str());
      if (window || (done % kEvery && done != frames)) continue;
      draw();
      application.waitForFrame();
      writePng(compositor, std::filesystem::path(arguments.out) / ("frame" + std::to_string(done) + ".png"));
    }
  };
  for (std::size_t i = 0; i < frames && !(window && window->closed()); ++i) {
    if (!sequence->read(i, frame, problem)) {
      std::fprintf(stderr, "%s\n", problem.c_str());
      continue;
    }
    while (
        !reconstructor.push({{frame.depth.ptr<std::uint16_t>(), frame.depth.total()}, frame.timestamp, {}})) {
      take();
      if (window) draw();
    }
  }
  reconstructor.wait();
  take();
  while (window && !window->closed() && arguments.frames > sequence->size()) draw();  // until it is closed
  application.waitForFrame();
  std::printf("%zu frames, %zu voxel blocks, on %s\n", done, reconstructor.blockCount(),
              reconstructor.device().c_str());
  for (const std::string& message : application.messages()) std::fprintf(stderr, "%s\n", message.c_str());
  return application.messages().empty() ? 0 : 1;
}

}  // namespace

int main(int count, char** texts) {
  try {
    return run(parse(count, texts));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
