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
  raw_ = Uploaded(device, 2 * pixels);
  own_depth_ = Buffer(device, 4 * pixels, Memory::Device);
  frame_.depth = Buffer(device, 4 * pixels, Memory::Device);
  frame_.points = Buffer(device, 16 * pixels, Memory::Device);
  frame_.colour = Buffer(device, 16, Memory::Upload);
  frame_.tile_columns = tilesAlong(camera.size.x);
  frame_.tile_rows = tilesAlong(camera.size.y);
  frame_.tile_pixels = shader::kFarthestTile;
  frame_.tiles = Buffer(device, 4ull * frame_.tile_columns * frame_.tile_rows, Memory::Readback);
}

void PreprocessPass::record(Recorder& recorder, std::span<const std::uint16_t> raw, float metres_per_unit,
                            float min_depth, float max_depth, float edge_sigmas, const SensorNoise& noise,
                            float voxel_size) {
  const Recorder::Whole whole(recorder);
  if (raw.size() != static_cast<std::size_t>(camera_.size.x) * camera_.size.y)
    throw DeviceError(DeviceErrorCode::Programming, "The depth image has not the camera's size.");
  std::memcpy(raw_.as<char>().data(), raw.data(), raw.size_bytes());
  raw_.record(recorder);
  recordKernel(recorder, metres_per_unit, min_depth, max_depth, edge_sigmas, noise, voxel_size);
}

void PreprocessPass::record(Recorder& recorder, const DevicePixels& raw, float metres_per_unit,
                            float min_depth, float max_depth, float edge_sigmas, const SensorNoise& noise,
                            float voxel_size) {
  const Recorder::Whole whole(recorder);
  recorder.copyPixels(raw, raw_.buffer(), static_cast<std::uint32_t>(camera_.size.x),
                      static_cast<std::uint32_t>(camera_.size.y), 2);
  recordKernel(recorder, metres_per_unit, min_depth, max_depth, edge_sigmas, noise, voxel_size);
}

void PreprocessPass::recordKernel(Recorder& recorder, float metres_per_unit, float min_depth, float max_depth,
                                  float edge_sigmas, const SensorNoise& noise, float voxel_size) {
  const auto pixels = static_cast<std::uint32_t>(camera_.size.x * camera_.size.y);
  const shader::PreprocessParams params{camera_.size, metres_per_unit, min_depth, max_depth, edge_sigmas,
                                        noise.floor,  noise.growth,    0,         0};
  const std::uint32_t per_group = 2 * shader::kPreprocessGroup;
  recorder.dispatch(kernel_, {raw_.buffer(), own_depth_}, params,
                    Groups{(pixels + per_group - 1) / per_group});
  footprint_.record(recorder, raw_.buffer(), own_depth_, frame_.depth, frame_.points, voxel_size, noise,
                    min_depth, max_depth);
  const int columns = frame_.tile_columns, rows = frame_.tile_rows;
  const shader::FarthestParams tiles{glm::ivec4(camera_.size.x, camera_.size.y, columns, rows)};
  recorder.dispatch(farthest_, {frame_.depth, frame_.tiles}, tiles,
                    Threads{static_cast<std::uint32_t>(columns * rows)});
}

std::span<std::uint32_t> PreprocessPass::colourWords() {
  const auto pixels = static_cast<std::size_t>(camera_.size.x) * camera_.size.y;
  if (colour_.bytes() < 4 * pixels) {
    colour_ = Uploaded(device_, 4 * pixels);
    frame_.colour = colour_.buffer();
  }
  return colour_.as<std::uint32_t>().first(pixels);
}

void PreprocessPass::recordColour(Recorder& recorder) {
  const Recorder::Whole whole(recorder);
  if (colour_.bytes() > 0) colour_.record(recorder);
  frame_.has_colour = colour_.bytes() > 0;
}

}  // namespace rosefusion
