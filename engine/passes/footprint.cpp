#include "engine/passes/footprint.h"

#include <algorithm>

namespace rosefusion {

using namespace shader;

namespace {

/// Columns and rows of a level's cells.
glm::ivec2 cellsOf(const CameraIntrinsics& camera, int level) {
  const int side = kFootprintSide << level;
  return {(camera.size.x + side - 1) / side, (camera.size.y + side - 1) / side};
}

std::uint32_t numberOf(glm::ivec2 cells) {
  return static_cast<std::uint32_t>(cells.x) * static_cast<std::uint32_t>(cells.y);
}

/// Laid out on x and y, since images may have more cells than a device runs workgroups along x.
Groups groupsOf(glm::ivec2 cells) {
  return {(numberOf(cells) + kFootprintGroup - 1) / kFootprintGroup};
}

}  // namespace

FootprintPass::FootprintPass(Device& device, const CameraIntrinsics& camera)
    : camera_(camera),
      moments_(device, readerCode(device, "depth_moments"), 3, sizeof(MomentsParams)),
      footprint_(device, readerCode(device, "footprint"), kFootprintBindings, sizeof(FootprintParams)) {
  for (int level = 0; level < kFootprintLevels; ++level)
    cells_[level] = Buffer(device, 16ull * kMomentVectors * numberOf(cellsOf(camera, level)), Memory::Device);
}

void FootprintPass::record(Recorder& recorder, const Buffer& raw, const Buffer& own, const Buffer& depth,
                           const Buffer& points, float voxel_size, const SensorNoise& noise, float min_depth,
                           float max_depth) {
  for (int level = 0; voxel_size > 0 && level < kFootprintLevels; ++level) {
    const glm::ivec2 cells = cellsOf(camera_, level), finer = cellsOf(camera_, std::max(level - 1, 0));
    const MomentsParams params{{camera_.size.x, camera_.size.y, finer.x, finer.y},
                               {cells.x, cells.y, level, 0}};
    const Buffer& below = cells_[level == 0 ? 1 : level - 1];
    recorder.dispatch(moments_, {own, below, cells_[level]}, params, groupsOf(cells));
  }
  const glm::ivec2 cells = cellsOf(camera_, 0);
  const FootprintParams params{camera_.focal_centre,
                               {camera_.size.x, camera_.size.y, cells.x, cells.y},
                               voxel_size,
                               noise.floor,
                               noise.growth,
                               min_depth,
                               max_depth};
  recorder.dispatch(footprint_, {raw, own, cells_[0], cells_[1], cells_[2], cells_[3], depth, points}, params,
                    groupsOf(cells));
}

}  // namespace rosefusion
