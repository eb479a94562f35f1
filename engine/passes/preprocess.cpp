#include "engine/passes/preprocess.h"

#include <cstring>

#include "engine/error.h"

namespace rosefusion {
namespace {

int tilesAlong(int pixels) {
  return (pixels + shader::kFarthestTile - 1) / shader::kFarthestTile;
}

}  // namespace

PreprocessPass::PreprocessPass(Device& device, const shader::CameraIntrinsics& camera)
    : device_(device),
      camera_(camera),
      kernel_(device, readerCode(device, "preprocess"), 2, sizeof(shader::PreprocessParams)),
      farthest_(device, readerCode(device, "farthest"), 2, sizeof(shader::FarthestParams)),
      footprint_(device, camera) {
  const auto pixels = static_cast<std::uint64_t>(camera.size.x) * camera.size.y;
  raw_ = Buffer(device, 2 * pixels, Memory::Upload);
  depth_ = Buffer(device, 4 * pixels, Memory::Device);
  own_depth_ = Buffer(device, 4 * pixels, Memory::Device);
  points_ = Buffer(device, 16 * pixels, Memory::Device);
  tiles_ = Buffer(device, 4ull * tilesAlong(camera.size.x) * tilesAlong(camera.size.y), Memory::Readback);
  colour_ = Buffer(device, 16, Memory::Upload);
}

void PreprocessPass::record(Recorder& recorder, std::span<const std::uint16_t> raw, float metres_per_unit,
                            float min_depth, float max_depth, float edge_sigmas, const SensorNoise& noise,
                            float voxel_size) {
  const Recorder::Whole whole(recorder);
  if (raw.size() != static_cast<std::size_t>(camera_.size.x) * camera_.size.y)
    throw DeviceError(DeviceErrorCode::Programming, "The depth image has not the camera's size.");
  std::memcpy(raw_.as<char>().data(), raw.data(), raw.size_bytes());
  recordKernel(recorder, metres_per_unit, min_depth, max_depth, edge_sigmas, noise, voxel_size);
}

void PreprocessPass::record(Recorder& recorder, const DevicePixels& raw, float metres_per_unit,
                            float min_depth, float max_depth, float edge_sigmas, const SensorNoise& noise,
                            float voxel_size) {
  const Recorder::Whole whole(recorder);
  recorder.copyPixels(raw, raw_, static_cast<std::uint32_t>(camera_.size.x),
                      static_cast<std::uint32_t>(camera_.size.y), 2);
  recordKernel(recorder, metres_per_unit, min_depth, max_depth, edge_sigmas, noise, voxel_size);
}

void PreprocessPass::recordKernel(Recorder& recorder, float metres_per_unit, float min_depth, float max_depth,
                                  float edge_sigmas, const SensorNoise& noise, float voxel_size) {
  const auto pixels = static_cast<std::uint32_t>(camera_.size.x * camera_.size.y);
  const shader::PreprocessParams params{camera_.size, metres_per_unit, min_depth, max_depth, edge_sigmas,
                                        noise.floor,  noise.growth,    0,         0};
  const std::uint32_t per_group = 2 * shader::kPreprocessGroup;
  const Buffer* buffers[] = {&raw_, &own_depth_};
  recorder.dispatchGroups(kernel_, buffers, &params, sizeof(params), (pixels + per_group - 1) / per_group);
  footprint_.record(recorder, raw_, own_depth_, depth_, points_, voxel_size, noise);
  const int columns = tilesAlong(camera_.size.x), rows = tilesAlong(camera_.size.y);
  const shader::FarthestParams tiles{glm::ivec4(camera_.size.x, camera_.size.y, columns, rows)};
  recorder.dispatch(farthest_, {&depth_, &tiles_}, tiles, {static_cast<std::uint32_t>(columns * rows)});
}

DepthReach PreprocessPass::reach() const {
  const int columns = tilesAlong(camera_.size.x), rows = tilesAlong(camera_.size.y);
  return {tiles_.as<float>().first(std::size_t(columns) * rows), columns, shader::kFarthestTile};
}

void PreprocessPass::setColour(std::span<const std::uint32_t> rgb) {
  const auto pixels = static_cast<std::size_t>(camera_.size.x) * camera_.size.y;
  if (rgb.size() != pixels)
    throw DeviceError(DeviceErrorCode::Programming, "The colour image has not the camera's size.");
  if (colour_.bytes() < rgb.size_bytes()) colour_ = Buffer(device_, rgb.size_bytes(), Memory::Upload);
  std::memcpy(colour_.as<char>().data(), rgb.data(), rgb.size_bytes());
  has_colour_ = true;
}

}  // namespace rosefusion
