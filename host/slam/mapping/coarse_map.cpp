#include "host/slam/mapping/coarse_map.h"

#include <algorithm>
#include <utility>

namespace rosefusion {
namespace {

constexpr float kCoarser = 4;        // than the model's voxels
constexpr float kTruncation = 0.4f;  // places within this descend to the surface

VolumeOptions coarseOptions(const VolumeSettings& s) {
  VolumeOptions out = volumeOptions(s);
  out.voxel_size *= kCoarser;
  out.truncation = std::max(kTruncation, 3 * out.voxel_size);
  out.colour = false;
  out.memory_limit_bytes = 0;
  return out;
}

}  // namespace

CoarseMap::CoarseMap(Device& device, const VolumeSettings& settings)
    : volume_(device, coarseOptions(settings)) {}

void CoarseMap::refresh(const std::function<void(Volume&)>& rebuild) {
  if (std::exchange(expired_, false)) rebuild(volume_);
}

void CoarseMap::clear() {
  volume_.clear();
  expired_ = false;
}

}  // namespace rosefusion
