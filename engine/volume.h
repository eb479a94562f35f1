// The voxel-block volume on the device: page table, pools that grow, and the host's list of blocks.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "engine/buffer.h"
#include "engine/depth_reach.h"
#include "engine/passes/table_entries.h"
#include "engine/recorder.h"
#include "shaders/compute/interface/volume.h"

namespace rosefusion {

struct VolumeOptions {
  float voxel_size = 0.02f;
  float truncation = 0.06f;
  float max_weight = 128;  ///< at most 255
  bool colour = false;
  std::uint64_t memory_limit_bytes = 0;  ///< of the volume; 0: 80 % of the device's memory
  std::uint64_t max_pool_bytes =
      0;                    ///< of one pool buffer; 0: what a binding covers. Small in tests of many pools
  bool thin_walls = false;  ///< keep a surface apart from one close behind it that faces the other way
};

/// Where the volume's contents are copied for tests and exports: slot-major, voxels with x fastest.
struct VolumeContents {
  std::vector<glm::ivec4> blocks;  ///< block coordinate per slot; slot 0 is the unobserved block
  std::vector<float> tsdf;         ///< [-1, 1], kBlockVoxels per slot
  std::vector<float> weight;
  std::vector<std::uint32_t>
      colour;  ///< red in the low byte, its own weight in the top one; empty without colour
};

/// The volume as the shaders that read it see it: what a pass binds. A copy keeps its buffers alive, and goes
/// on reading the same blocks, with what is fused into them later, where the Volume itself has grown into new
/// ones.
class VolumeView {
 public:
  const VolumeOptions& options() const { return options_; }
  std::uint32_t blockCount() const { return block_count_; }
  /// Pool buffers in use: specialisation constant 0 of every kernel that includes lib/volume.glsl.
  std::uint32_t chunks() const { return chunks_; }
  const Buffer& layoutBuffer() const { return layout_; }
  const Buffer& table() const { return table_; }
  const Buffer& blockBuffer() const { return block_buffer_; }
  /// The kMaxPoolChunks pool buffers of a kind; beyond those in use the first is repeated.
  BoundBuffers tsdf() const { return {pools_[0], chunks_}; }
  BoundBuffers weight() const { return {pools_[1], chunks_}; }
  /// Without colour: the TSDF pool, which the shader then does not touch.
  BoundBuffers colour() const { return {pools_[options_.colour ? 2 : 0], chunks_}; }

 protected:
  VolumeOptions options_;
  std::uint32_t block_count_ = 0;
  std::uint32_t chunks_ = 1;
  Buffer layout_, table_, block_buffer_;
  std::array<std::array<Buffer, shader::kMaxPoolChunks>, 3> pools_;  ///< [TSDF, weight, colour][chunk]
};

/// Grows on demand; nothing is ever evicted. Growing submits work of its own and waits: call it between
/// frames. A failed growth (DeviceError OutOfMemory, naming the settings to change) leaves the volume as it
/// was.
class Volume : public VolumeView {
 public:
  /// Throws DeviceError: Programming for options outside their range, OutOfMemory for a limit below the first
  /// pools.
  Volume(Device& device, const VolumeOptions& options);

  const VolumeView& view() const { return *this; }
  /// Block coordinates by slot, slot 0 (the unobserved block) included.
  std::span<const glm::ivec4> blocks() const { return blocks_; }
  std::uint64_t memoryBytes() const;

  /// Enlarges the page table so that it covers the block coordinates min..max (inclusive).
  void cover(glm::ivec3 min, glm::ivec3 max);
  /// Gives slots to the table entries (linear indices), in ascending order whatever order they come in. What
  /// `recorder` records next finds them; where the pools must grow, it first runs what was recorded before.
  void addBlocks(Recorder& recorder, std::vector<std::uint32_t> entries);
  /// Brings the device to what the host knows: takes back kRequested marks that were given no slot, and makes
  /// up for commands of addBlocks() that were discarded.
  void restore();
  /// Does what a failed restore() could not.
  void settle();
  /// Forgets all blocks; the pools stay. Views of it read what is fused next.
  void clear();
  /// Slots whose block may be seen by the camera: in front of it, inside its image, nearer than `far`, and
  /// not farther behind the surfaces of the image with this `reach` than the truncation.
  void visibleBlocks(const glm::mat4& camera_from_world, glm::vec4 focal_centre, glm::ivec4 size, float far,
                     const DepthReach& reach, std::vector<std::uint32_t>& slots) const;
  VolumeContents download();
  /// A second page table, in which AllocatePass may mark: others may read table() meanwhile.
  const Buffer& requestTable() const { return request_table_; }

 private:
  void reserve(std::uint32_t slots);
  void growChunk(std::uint32_t chunk, std::uint32_t size);
  void recordTable(const std::vector<std::uint32_t>& entries, const Buffer& table,
                   const Buffer& request_table);
  void recordLayout(glm::ivec3 table_origin, glm::ivec3 table_size, const Buffer& to);
  void requireRoom(std::uint64_t bytes) const;
  Buffer& staging(std::uint64_t bytes);

  Device& device_;
  Recorder recorder_;
  std::uint64_t memory_limit_bytes_ = 0;
  std::uint32_t chunk_shift_ = 0;  ///< log2 of the most blocks per pool buffer
  std::uint32_t capacity_ = 0;     ///< slots that fit into the pools now
  glm::ivec3 table_origin_{0};
  glm::ivec3 table_size_{3};
  std::vector<std::uint32_t> table_mirror_;
  std::vector<glm::ivec4> blocks_;
  TableEntriesPass table_entries_;
  Buffer request_table_, staging_, layout_staging_, coordinates_;
  bool stale_ = false;  ///< restore() was called for, and failed
};

}  // namespace rosefusion
