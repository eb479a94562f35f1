#include "host/slam/mapping/frame_integrator.h"

#include "host/core/error.h"
#include "host/slam/shader_types.h"

namespace rosefusion {

VolumeOptions volumeOptions(const VolumeSettings& s) {
  VolumeOptions out;
  out.voxel_size = static_cast<float>(s.voxel_size);
  out.truncation = static_cast<float>(s.truncation);
  out.max_weight = static_cast<float>(s.max_weight);
  out.colour = s.colour;
  out.memory_limit_bytes = s.memory_limit_mb << 20;
  out.thin_walls = s.thin_walls;
  return out;
}

FrameIntegrator::FrameIntegrator(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                                 double depth_units_per_metre)
    : settings_(settings),
      intrinsics_(intrinsics),
      depth_units_per_metre_(depth_units_per_metre),
      preprocess_(device, toShader(intrinsics)),
      allocate_(device),
      integrate_(device) {}

template <typename Depth>
void FrameIntegrator::recordDepth(Recorder& recorder, const Depth& depth) {
  preprocess_.record(recorder, depth, static_cast<float>(1 / depth_units_per_metre_),
                     static_cast<float>(settings_.depth.min), static_cast<float>(settings_.depth.max),
                     static_cast<float>(settings_.depth.edge_sigmas), toShader(settings_.depth),
                     settings_.depth.footprint ? static_cast<float>(settings_.volume.voxel_size) : 0);
}

void FrameIntegrator::recordFrame(Recorder& recorder, const DevicePixels& depth) {
  recordDepth(recorder, depth);
  preprocess_.clearColour();
}

void FrameIntegrator::recordFrame(Recorder& recorder, const Frame& frame) {
  const cv::Mat depth = frame.depth.isContinuous() ? frame.depth : frame.depth.clone();
  if (depth.type() != CV_16UC1 || depth.cols != intrinsics_.width || depth.rows != intrinsics_.height)
    throw InputError("A depth frame must be a 16-bit image of " + std::to_string(intrinsics_.width) + " x " +
                     std::to_string(intrinsics_.height) + " pixels, as the camera was described.");
  recordDepth(recorder, std::span<const std::uint16_t>(depth.ptr<std::uint16_t>(), depth.total()));
  if (!settings_.volume.colour || frame.colour.size() != depth.size() || frame.colour.type() != CV_8UC3)
    return preprocess_.clearColour();
  std::uint32_t* word = preprocess_.colourWords().data();
  for (int row = 0; row < depth.rows; ++row) {
    const std::uint8_t* p = frame.colour.ptr(row);
    for (int column = 0; column < depth.cols; ++column, p += 3)
      *word++ = std::uint32_t(p[2]) | std::uint32_t(p[1]) << 8 | std::uint32_t(p[0]) << 16;
  }
  preprocess_.recordColour(recorder);
}

void FrameIntegrator::recordSearch(Recorder& recorder, const Volume& volume, const Pose& world_from_camera) {
  allocate_.record(recorder, volume, preprocess_.frame(), toShader(intrinsics_), toShader(world_from_camera));
}

void FrameIntegrator::recordFusion(Recorder& recorder, const Volume& volume, const Pose& world_from_camera) {
  integrate_.record(
      recorder, volume, preprocess_.frame(), toShader(intrinsics_), toShader(world_from_camera.inverse()),
      static_cast<float>(settings_.depth.max + settings_.volume.truncation), toShader(settings_.depth));
}

void FrameIntegrator::fuse(Recorder& recorder, Volume& volume, const Pose& world_from_camera) {
  volume.settle();
  try {
    do {
      recordSearch(recorder, volume, world_from_camera);
      recorder.submit();
    } while (grow(recorder, volume));
    recordFusion(recorder, volume, world_from_camera);
    recorder.start();
  } catch (...) {
    volume.restore();  // what grow() recorded is gone, or requests of a search that ran unseen stay marked
    throw;
  }
}

}  // namespace rosefusion
