// Reference of pass allocate: the exact set of blocks that the truncation bands of an image touch.
#pragma once
#include <array>
#include <set>
#include <span>
#include <vector>

#include "tests/reference/preprocess.h"

namespace rosefusion::reference {

using Block = std::array<int, 3>;  ///< block coordinate: floor of the position in units of 8 voxels

struct BandOptions {
  double voxel_size = 0.04;
  double half_length = 0.16;  ///< metres along the ray, either side of the surface
  int pixel_stride = 2;       ///< the pass looks at every second pixel of every second row
};

class BandBlocks {
 public:
  explicit BandBlocks(const BandOptions& options) : options_(options), side_(8 * options.voxel_size) {}
  void add(const PointImage& image, const Intrinsics& camera, const Pose& world_from_camera);

  /// Blocks that hold an end of a band, or more of it than the pass's sampling distance (a quarter of a
  /// block).
  const std::set<Block>& required() const { return required_; }
  /// Whether any band comes nearer to the block than the rounding of single precision.
  bool mayTouch(const Block& block) const;

 private:
  struct Segment {
    Eigen::Vector3d from, to;
  };
  void addRequired(const Segment& segment);
  bool clearlyInside(const Eigen::Vector3d& point, const Block& block) const;

  BandOptions options_;
  double side_;  ///< of a block, metres
  std::vector<Segment> segments_;
  std::set<Block> required_;
};

/// Every required block must be among `allocated`, and every allocated one must touch a band.
Comparison compare(const BandBlocks& expected, std::span<const Block> allocated);

}  // namespace rosefusion::reference
