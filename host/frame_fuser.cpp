#include "host/frame_fuser.h"

#include "host/error.h"
#include "host/shader_types.h"

namespace rosefusion {
namespace {

std::vector<std::uint32_t> packColour(const cv::Mat& bgr) {
  std::vector<std::uint32_t> rgb;
  rgb.reserve(bgr.total());
  for (int row = 0; row < bgr.rows; ++row)
    for (int column = 0; column < bgr.cols; ++column) {
      const auto& p = bgr.at<cv::Vec3b>(row, column);
      rgb.push_back(p[2] | p[1] << 8 | p[0] << 16);
    }
  return rgb;
}

}  // namespace

FrameFuser::FrameFuser(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                       double depth_units_per_metre)
    : settings_(settings),
      intrinsics_(intrinsics),
      depth_units_per_metre_(depth_units_per_metre),
      preprocess_(device, toShader(intrinsics)),
      allocate_(device),
      integrate_(device) {}

template <typename Depth>
void FrameFuser::recordDepth(Recorder& recorder, const Depth& depth) {
  preprocess_.record(recorder, depth, static_cast<float>(1 / depth_units_per_metre_),
                     static_cast<float>(settings_.depth.min), static_cast<float>(settings_.depth.max),
                     static_cast<float>(settings_.depth.edge_sigmas), toShader(settings_.depth));
}

void FrameFuser::recordFrame(Recorder& recorder, const DevicePixels& depth) {
  recordDepth(recorder, depth);
  preprocess_.clearColour();
}

void FrameFuser::recordFrame(Recorder& recorder, const Frame& frame) {
  const cv::Mat depth = frame.depth.isContinuous() ? frame.depth : frame.depth.clone();
  if (depth.type() != CV_16UC1 || depth.cols != intrinsics_.width || depth.rows != intrinsics_.height)
    throw InputError("A depth frame must be a 16-bit image of " + std::to_string(intrinsics_.width) + " x " +
                     std::to_string(intrinsics_.height) + " pixels, as the camera was described.");
  recordDepth(recorder, std::span<const std::uint16_t>(depth.ptr<std::uint16_t>(), depth.total()));
  if (settings_.volume.colour && frame.colour.size() == depth.size() && frame.colour.type() == CV_8UC3)
    preprocess_.setColour(packColour(frame.colour));
  else
    preprocess_.clearColour();
}

void FrameFuser::recordSearch(Recorder& recorder, const Volume& volume, const Pose& world_from_camera) {
  allocate_.record(recorder, volume, preprocess_, toShader(intrinsics_), toShader(world_from_camera));
}

void FrameFuser::recordFusion(Recorder& recorder, const Volume& volume, const Pose& world_from_camera) {
  integrate_.record(
      recorder, volume, preprocess_, toShader(intrinsics_), toShader(world_from_camera.inverse()),
      static_cast<float>(settings_.depth.max + settings_.volume.truncation), toShader(settings_.depth));
}

void FrameFuser::fuse(Recorder& recorder, Volume& volume, const Pose& world_from_camera) {
  do {
    recordSearch(recorder, volume, world_from_camera);
    recorder.submit();
  } while (grow(volume));
  recordFusion(recorder, volume, world_from_camera);
  recorder.submit();
}

}  // namespace rosefusion
