// Reference of pass integrate: a sparse TSDF in double precision, without quantisation.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "tests/reference/allocate.h"
#include "tests/reference/depth_noise.h"

namespace rosefusion::reference {

struct TsdfOptions {
  double voxel_size = 0.04;
  double truncation = 0.12;
  double max_weight = 128;
  bool thin_walls =
      false;  ///< of views that contradict each other behind surfaces, the larger distance counts
  double thin_walls_deviations = 4;  ///< of the noise, the least contradiction
  DepthNoise noise;  ///< a depth weighs its inverse variance, at least one unit of the stored weights
};

struct Voxel {
  double tsdf = 1;  ///< units of the truncation
  double weight = 0;
  int updates = 0;
  bool replaced = false, kept = false;  ///< by or against a view that contradicted, with thin_walls
  double tsdf_error = 0;  ///< the most that storing tsdf and weight after each update may have added up to
  double weight_error = 0;
  Eigen::Vector3d rgb{0, 0, 0};  ///< [0, 255]
  int colour_updates = 0;
  bool uncertain = false;         ///< rounding decides which pixel it saw, or whether it was updated
  bool colour_uncertain = false;  ///< the same of its colour
};

class TsdfMap {
 public:
  explicit TsdfMap(const TsdfOptions& options) : options_(options) {}

  /// Fuses the image into all voxels of `blocks`, listed or seen before; no culling. `rgb` may be empty.
  void integrate(std::span<const Block> blocks, const PointImage& image, std::span<const std::uint32_t> rgb,
                 const Intrinsics& camera, const Pose& world_from_camera);

  const TsdfOptions& options() const { return options_; }
  /// 512 voxels per block, x fastest.
  const std::map<Block, std::vector<Voxel>>& blocks() const { return blocks_; }

 private:
  void update(Voxel& voxel, const Eigen::Vector3d& in_camera, const PointImage& image,
              std::span<const std::uint32_t> rgb, const Intrinsics& camera) const;

  TsdfOptions options_;
  std::map<Block, std::vector<Voxel>> blocks_;
};

/// What a pass made of the same frames: per block 512 voxels; `colour` (0xWWBBGGRR) may be empty.
struct TsdfContents {
  std::vector<Block> blocks;
  std::span<const float> tsdf;
  std::span<const float> weight;
  std::span<const std::uint32_t> colour;
};

Comparison compare(const TsdfMap& expected, const TsdfContents& contents);
Comparison compareColour(const TsdfMap& expected, const TsdfContents& contents);

}  // namespace rosefusion::reference
