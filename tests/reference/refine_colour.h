// Reference of pass refine_colour: the normal equations of image against model luminance, in double
// precision.
#pragma once
#include <map>
#include <span>
#include <vector>

#include "tests/reference/refine.h"

namespace rosefusion::reference {

/// The colours of a volume as they stand, voxel by voxel.
class VoxelColours {
 public:
  VoxelColours(std::span<const Block> blocks, std::span<const std::uint32_t> colour, double voxel_size);
  /// In [0, 1], by Rec. 601; nothing where no colour was fused.
  std::optional<double> luminanceAt(const Eigen::Vector3i& voxel) const;
  double voxelSize() const { return voxel_size_; }

 private:
  std::map<Block, std::span<const std::uint32_t>> blocks_;
  double voxel_size_;
};

struct ColourModel {
  Intrinsics camera;
  std::span<const std::uint32_t> image;  ///< red in the low byte
  double huber = 0.06;                   ///< of white
  double gain = 1;                       ///< brightness of the image, in units of the volume's
  double turn_sense = 1;                 ///< of the turns' derivatives; -1 only to be wrong
  double green = 0.587;                  ///< weight in the image's luminance; another only to be wrong
};

/// In this order: 28 of the upper triangle of J^T W J, row by row; 7 of J^T W r; the robust cost; the number
/// of points. Unknowns: those of refineSums(), and the gain.
constexpr int kRefineColourSums = 37;

std::vector<SumRange> refineColourSums(const VoxelColours& colours, std::span<const Eigen::Vector3d> points,
                                       const Pose& world_from_camera, const ColourModel& model);

}  // namespace rosefusion::reference
