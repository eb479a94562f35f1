#include "host/bench/bench_scene.h"

#include <algorithm>

#include "host/slam/mapping/frame_integrator.h"
#include "host/slam/shader_types.h"

namespace rosefusion {
namespace {

constexpr double kFps = 10;  // few frames that see much

SynthSequence sequenceFor(const BenchOptions& options) {
  SynthOptions synth;
  synth.frames = options.frames;
  synth.fps = kFps;
  synth.seed = options.seed;
  synth.colour = options.settings.volume.colour;
  return makeSequence(synth);
}

std::vector<std::uint32_t> packColour(const cv::Mat& bgr) {
  std::vector<std::uint32_t> rgb;
  rgb.reserve(bgr.total());
  for (const cv::Vec3b& p : cv::Mat_<cv::Vec3b>(bgr)) rgb.push_back(p[2] | p[1] << 8 | p[0] << 16);
  return rgb;
}

}  // namespace

BenchScene::BenchScene(Device& device, const BenchOptions& options)
    : device_(device),
      options_(options),
      sequence_(sequenceFor(options)),
      camera_(toShader(sequence_.intrinsics)),
      recorder_(device),
      volume_(device, volumeOptions(options.settings.volume)),
      frame_(device, camera_),
      allocate_(device),
      integrate_(device) {}

std::span<const std::uint16_t> BenchScene::raw(std::size_t i) const {
  const cv::Mat& depth = sequence_.frames[i].depth;
  return {depth.ptr<std::uint16_t>(), depth.total()};
}

NativePreprocessing BenchScene::preprocessing() const {
  const DepthSettings& depth = options_.settings.depth;
  return {camera_,
          static_cast<float>(1 / sequence_.depth_units_per_metre),
          static_cast<float>(depth.min),
          static_cast<float>(depth.max),
          static_cast<float>(depth.edge_sigmas),
          toShader(depth),
          depth.footprint ? volume_.options().voxel_size : 0};
}

void BenchScene::load(std::size_t i) {
  const NativePreprocessing p = preprocessing();
  frame_.record(recorder_, raw(i), p.metres_per_unit, p.min_depth, p.max_depth, p.edge_sigmas, p.noise,
                p.voxel_size);
  recorder_.submit();
  if (sequence_.frames[i].colour.empty()) return;
  std::ranges::copy(packColour(sequence_.frames[i].colour), frame_.colourWords().begin());
  frame_.recordColour(recorder_);
}

void BenchScene::allocateBlocks(std::size_t i) {
  do {
    allocate_.record(recorder_, volume_, frame_.frame(), camera_, toShader(truth(i)));
    recorder_.submit();
  } while (allocate_.finish(recorder_, volume_));
  recorder_.submit();
}

float BenchScene::farthest() const {
  return static_cast<float>(options_.settings.depth.max + options_.settings.volume.truncation);
}

void BenchScene::integrate(std::size_t i) {
  integrate_.record(recorder_, volume_, frame_.frame(), camera_, toShader(truth(i).inverse()), farthest(),
                    toShader(options_.settings.depth));
  recorder_.submit();
}

NativeFusion BenchScene::fusion(std::size_t i) const {
  const VolumeOptions& v = volume_.options();
  return {camera_,
          toShader(truth(i).inverse()),
          toShader(options_.settings.depth),
          v.truncation,
          v.max_weight,
          v.thin_walls};
}

void BenchScene::visibleBlocks(std::size_t i, std::vector<std::uint32_t>& slots) const {
  volume_.visibleBlocks(toShader(truth(i).inverse()), camera_.focal_centre, camera_.size, farthest(),
                        frame_.frame().reach(), slots);
}

std::vector<glm::vec4> BenchScene::selectPoints(SelectPointsPass& select, int stride) {
  select.record(recorder_, frame_.frame(), {stride, stride / 2, stride / 2}, nullptr);
  recorder_.submit();
  return fetch<glm::vec4>(select.points(), select.selected());
}

}  // namespace rosefusion
