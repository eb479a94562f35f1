#include "tests/reference/raycast_field.h"

#include <limits>

namespace rosefusion::reference {

Field::Field(std::span<const Eigen::Vector3i> blocks, std::span<const float> tsdf,
             std::span<const float> weight, double voxel_size)
    : voxel_size_(voxel_size) {
  Eigen::Vector3i low = Eigen::Vector3i::Constant(std::numeric_limits<int>::max()), high = -low;
  for (const auto& block : blocks) {
    low = low.cwiseMin(block);
    high = high.cwiseMax(block);
  }
  low_ = 8 * low;
  size_ = 8 * (high - low + Eigen::Vector3i::Ones());
  tsdf_.assign(std::size_t(size_.x()) * size_.y() * size_.z(), 1.0f);
  weight_.assign(tsdf_.size(), 0.0f);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (int z = 0; z < 8; ++z)
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
          const std::size_t from = 512 * b + 64 * z + 8 * y + x,
                            to = index(8 * blocks[b] + Eigen::Vector3i(x, y, z));
          tsdf_[to] = tsdf[from];
          weight_[to] = weight[from];
        }
}

}  // namespace rosefusion::reference
