// A volume's contents for the references of raycast and extract: one dense array, doubles.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace rosefusion::reference {

/// Voxel v has its centre at (v + 0.5) * voxel_size in the world. Outside the blocks nothing was observed.
class Field {
 public:
  /// `tsdf`, `weight`: 512 voxels per block, x fastest.
  Field(std::span<const Eigen::Vector3i> blocks, std::span<const float> tsdf, std::span<const float> weight,
        double voxel_size);

  double voxelSize() const { return voxel_size_; }
  const Eigen::Vector3i& low() const { return low_; }    ///< first voxel of the array
  const Eigen::Vector3i& size() const { return size_; }  ///< voxels per axis
  double tsdf(const Eigen::Vector3i& v) const { return inside(v) ? tsdf_[index(v)] : 1.0; }
  double weight(const Eigen::Vector3i& v) const { return inside(v) ? weight_[index(v)] : 0.0; }

 private:
  bool inside(const Eigen::Vector3i& v) const {
    return ((v - low_).array() >= 0).all() && ((v - low_).array() < size_.array()).all();
  }
  std::size_t index(const Eigen::Vector3i& v) const {
    const Eigen::Vector3i d = v - low_;
    return (std::size_t(d.z()) * size_.y() + d.y()) * size_.x() + d.x();
  }

  double voxel_size_;
  Eigen::Vector3i low_, size_;
  std::vector<float> tsdf_, weight_;
};

}  // namespace rosefusion::reference
