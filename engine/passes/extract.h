// Passes extract_count and extract_emit: the surface of the volume by marching cubes, a bounded number of
// blocks at a time.
#pragma once
#include <functional>
#include <span>

#include "engine/kernel_variants.h"
#include "engine/volume.h"
#include "shaders/compute/interface/extract_count.h"
#include "shaders/compute/interface/extract_emit.h"

namespace rosefusion {

/// Part of the surface; the spans are valid during the call that hands it over. An edge belongs to a block
/// (its number divided by kBlockEdges is the slot) and has a vertex wherever a triangle names it, in this
/// batch or another.
struct ExtractBatch {
  std::span<const shader::ExtractBlock> blocks;  ///< ascending slots; blocks that give nothing are left out
  std::span<const shader::ExtractVertex>
      vertices;  ///< per block in ascending order of edges; some serve no triangle
  std::span<const std::uint32_t> triangles;  ///< three edges each, counter-clockwise seen from free space
};

class ExtractPass {
 public:
  explicit ExtractPass(Device& device);

  /// Hands over the whole surface, the same batches in every run. Voxels observed fewer than `min_weight`
  /// times count as unobserved, and no surface is made beside unobserved voxels. Holds about 16 MiB of device
  /// memory meanwhile; submits work of its own and waits. Throws DeviceError, (OutOfMemory) for more than 2.7
  /// million blocks, which edge numbers cannot count.
  void run(const Volume& volume, float min_weight, const std::function<void(const ExtractBatch&)>& take);

 private:
  struct Work;
  void count(Work& work, std::uint32_t first_slot, std::uint32_t blocks);
  void emit(Work& work, std::span<const shader::ExtractBlock> listed);

  Device& device_;
  KernelVariants count_, emit_;  ///< by number of pool chunks
  Buffer cases_;
};

}  // namespace rosefusion
