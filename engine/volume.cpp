#include "engine/volume.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vector_relational.hpp>

#include "engine/error.h"

namespace rosefusion {
namespace {

using namespace shader;

constexpr std::uint32_t kFirstCapacity = 4096;  // blocks: 8 MiB, a fifth of a small room
constexpr double kGrowth = 1.5;
constexpr int kTableMargin = 8;  // blocks added around what must be covered
constexpr std::uint64_t kLargestPool = 1u
                                       << 30;  // bytes of one pool buffer, also where a binding may be larger
constexpr std::array<std::uint64_t, 3> kBlockBytes = {4 * kBlockTsdfWords, 4 * kBlockTsdfWords,
                                                      4 * kBlockColourWords};
constexpr std::array<std::uint32_t, 3> kEmptyWord = {kUnobservedTsdf, 0, 0};

constexpr int kFarthestBlock = 1 << 19;  // 84 km at 2 cm; table sizes up to here do not overflow 64 bits

void requireValid(const VolumeOptions& options) {
  const bool valid = std::isfinite(options.voxel_size) && options.voxel_size > 0 &&
                     std::isfinite(options.truncation) && options.truncation > 0 && options.max_weight >= 1 &&
                     options.max_weight <= 255 &&
                     (options.max_pool_bytes == 0 || options.max_pool_bytes >= kBlockBytes[2]);
  if (!valid)
    throw DeviceError(DeviceErrorCode::Programming,
                      "The volume's options are outside their range (voxel_size > 0, "
                      "truncation > 0, max_weight 1 to 255, max_pool_bytes 0 or 2048 up).");
}

std::uint64_t entriesOf(glm::ivec3 size) {
  return std::uint64_t(size.x) * size.y * size.z;
}

/// Where a voxel that is number `i` with x fastest lies in its pool: by cubes of 2^3 (see
/// interface/volume.h).
std::size_t storedIndex(std::size_t i) {
  const std::size_t x = i % 8, y = i / 8 % 8, z = i / 64 % 8, block = i / kBlockVoxels;
  const std::size_t cube = (z / 2 * 4 + y / 2) * 4 + x / 2, corner = (z % 2 * 2 + y % 2) * 2 + x % 2;
  return block * kBlockVoxels + cube * 8 + corner;
}

}  // namespace

Volume::Volume(Device& device, const VolumeOptions& options)
    : device_(device), recorder_(device), table_entries_(device) {
  requireValid(options);
  options_ = options;
  const DeviceLimits& limits = device.info().limits;
  memory_limit_bytes_ =
      options.memory_limit_bytes ? options.memory_limit_bytes : limits.memory_bytes / 10 * 8;
  std::uint64_t pool_bytes = std::min(limits.max_storage_buffer_bytes, kLargestPool);
  if (device.info().readsTexels()) pool_bytes = std::min(pool_bytes, std::uint64_t(4) * limits.max_texels);
  if (options.max_pool_bytes) pool_bytes = std::min(pool_bytes, options.max_pool_bytes);
  chunk_shift_ = std::bit_width(pool_bytes / (options.colour ? kBlockBytes[2] : kBlockBytes[0])) - 1;
  layout_ = Buffer(device, sizeof(VolumeLayout), Memory::Device);
  blocks_.push_back(glm::ivec4(0));
  table_mirror_.assign(entriesOf(table_size_), 0);
  table_ = Buffer(device, 4 * table_mirror_.size(), Memory::Device);
  request_table_ = Buffer(device, table_.bytes(), Memory::Device);
  reserve(1);
  recordLayout(table_origin_, table_size_, layout_);
  recorder_.submit();
}

std::uint64_t Volume::memoryBytes() const {
  std::uint64_t bytes = 2 * table_.bytes() + block_buffer_.bytes() + layout_.bytes();
  for (const auto& kind : pools_)
    for (const Buffer& buffer : kind) bytes += buffer.bytes();
  return bytes;
}

void Volume::requireRoom(std::uint64_t bytes) const {
  if (memoryBytes() + bytes > memory_limit_bytes_)
    throw DeviceError(
        DeviceErrorCode::OutOfMemory,
        "The volume has reached its limit of " + std::to_string(memory_limit_bytes_ >> 20) +
            " MiB; make volume.voxel_size larger, depth.max smaller, or raise volume.memory_limit_mb.");
}

Buffer& Volume::staging(std::uint64_t bytes) {
  if (staging_.bytes() < bytes) staging_ = Buffer(device_, bytes, Memory::Upload);
  return staging_;
}

void Volume::growChunk(std::uint32_t chunk, std::uint32_t size) {
  const int kinds = options_.colour ? 3 : 2;
  const std::uint32_t capacity = (chunk << chunk_shift_) + size;
  const std::uint64_t coordinate_bytes = sizeof(glm::ivec4) * capacity;
  std::uint64_t added = coordinate_bytes - block_buffer_.bytes();
  for (int kind = 0; kind < kinds; ++kind) added += size * kBlockBytes[kind] - pools_[kind][chunk].bytes();
  requireRoom(added);
  // All new buffers, and what fills them, before any old one goes: a failure changes nothing.
  staging(table_.bytes());
  Buffer coordinates(device_, coordinate_bytes, Memory::Device);
  Buffer table(device_, table_.bytes(), Memory::Device);  // the old one goes on naming slots of the old pools
  std::array<Buffer, 3> grown;
  for (int kind = 0; kind < kinds; ++kind)
    grown[kind] = Buffer(device_, size * kBlockBytes[kind], Memory::Device);
  const Recorder::Whole whole(recorder_);
  for (int kind = 0; kind < kinds; ++kind) {
    const std::uint64_t kept = pools_[kind][chunk].bytes();
    if (kept) recorder_.copy(pools_[kind][chunk], grown[kind], kept);
    recorder_.fill(grown[kind], kEmptyWord[kind], kept, grown[kind].bytes() - kept);
  }
  if (block_buffer_) recorder_.copy(block_buffer_, coordinates, block_buffer_.bytes());
  recordTable(table_mirror_, table, request_table_);
  recorder_.submit();
  for (int kind = 0; kind < kinds; ++kind) pools_[kind][chunk] = std::move(grown[kind]);
  block_buffer_ = std::move(coordinates);
  capacity_ = capacity;
  chunks_ = chunk + 1;
  table_ = std::move(table);
}

void Volume::reserve(std::uint32_t slots) {
  const std::uint32_t chunk_blocks = 1u << chunk_shift_;
  while (capacity_ < slots) {
    const std::uint32_t chunk = capacity_ >> chunk_shift_;
    const std::uint32_t most_chunks = device_.info().bindsAllChunks() ? kMaxPoolChunks : 1;
    if (chunk >= most_chunks)
      throw DeviceError(DeviceErrorCode::OutOfMemory,
                        "The scene needs more than " +
                            std::to_string(std::uint64_t(most_chunks) << chunk_shift_) +
                            " voxel blocks; make volume.voxel_size larger or depth.max smaller.");
    const std::uint32_t in_chunk = capacity_ & (chunk_blocks - 1);
    const std::uint32_t needed = std::min(chunk_blocks, slots - (chunk << chunk_shift_));
    const std::uint32_t wanted =
        std::min(chunk_blocks, std::max({needed, kFirstCapacity, std::uint32_t(in_chunk * kGrowth)}));
    try {
      growChunk(chunk, wanted);
    } catch (const DeviceError& error) {
      if (error.code() != DeviceErrorCode::OutOfMemory || wanted == needed) throw;
      growChunk(chunk, needed);  // the last room counts too
    }
  }
}

void Volume::recordLayout(glm::ivec3 table_origin, glm::ivec3 table_size, const Buffer& to) {
  const Recorder::Whole whole(recorder_);
  VolumeLayout layout{};
  layout.table_origin = glm::ivec4(table_origin, static_cast<int>(chunk_shift_));
  layout.table_size = glm::ivec4(table_size, 0);
  layout.scale =
      glm::vec4(options_.voxel_size, 1 / options_.voxel_size, options_.truncation, options_.max_weight);
  if (!layout_staging_) layout_staging_ = Buffer(device_, sizeof(layout), Memory::Upload);
  std::memcpy(layout_staging_.as<char>().data(), &layout, sizeof(layout));
  recorder_.copy(layout_staging_, to, sizeof(layout));
}

void Volume::recordTable(const std::vector<std::uint32_t>& entries, const Buffer& table,
                         const Buffer& request_table) {
  const Recorder::Whole whole(recorder_);
  const std::uint64_t bytes = 4 * entries.size();
  Buffer& stage = staging(bytes);
  std::memcpy(stage.as<char>().data(), entries.data(), bytes);
  recorder_.copy(stage, table, bytes);
  recorder_.copy(stage, request_table, bytes);
}

void Volume::restore() {
  stale_ = true;
  const std::uint64_t bytes = sizeof(glm::ivec4) * blocks_.size();
  {
    const Recorder::Whole whole(recorder_);
    Buffer& stage = staging(bytes);
    std::memcpy(stage.as<char>().data(), blocks_.data(), bytes);
    recorder_.copy(stage, block_buffer_, bytes);
  }
  recorder_.submit();
  recordTable(table_mirror_, table_, request_table_);
  recorder_.submit();
  stale_ = false;
}

void Volume::settle() {
  if (stale_) restore();
}

void Volume::cover(glm::ivec3 min, glm::ivec3 max) {
  const auto requireExtent = [](bool fits) {
    if (!fits)
      throw DeviceError(DeviceErrorCode::OutOfMemory,
                        "The scene's extent is too large for the page table; make "
                        "volume.voxel_size larger or depth.max smaller.");
  };
  requireExtent(glm::all(glm::greaterThan(min, glm::ivec3(-kFarthestBlock))) &&
                glm::all(glm::lessThan(max, glm::ivec3(kFarthestBlock))));
  glm::ivec3 low = min - kTableMargin, high = max + kTableMargin;
  if (blockCount() > 0) {
    // The old content lies inside the old table's border of 1.
    low = glm::min(low, table_origin_);
    high = glm::max(high, table_origin_ + table_size_ - 1);
  }
  const glm::ivec3 size = high - low + 1;
  const std::uint64_t bytes = 4 * entriesOf(size);
  requireExtent(bytes <= device_.info().limits.max_storage_buffer_bytes &&
                (!device_.info().readsTexels() || bytes / 4 <= device_.info().limits.max_texels));
  requireRoom(2 * (bytes - std::min(bytes, table_.bytes())));
  Buffer table(device_, bytes, Memory::Device), request_table(device_, bytes, Memory::Device);
  Buffer layout(device_, sizeof(VolumeLayout), Memory::Device);
  std::vector<std::uint32_t> mirror(entriesOf(size), 0);
  for (std::uint32_t slot = 1; slot < blocks_.size(); ++slot) {
    const glm::ivec3 entry = glm::ivec3(blocks_[slot]) - low;
    mirror[(std::size_t(entry.z) * size.y + entry.y) * size.x + entry.x] = slot;
  }
  const Recorder::Whole whole(recorder_);
  recordTable(mirror, table, request_table);
  recordLayout(low, size, layout);
  recorder_.submit();  // before anything changes
  table_mirror_ = std::move(mirror);
  table_ = std::move(table);
  request_table_ = std::move(request_table);
  layout_ = std::move(layout);
  table_origin_ = low;
  table_size_ = size;
}

void Volume::addBlocks(Recorder& recorder, std::vector<std::uint32_t> entries) {
  const Recorder::Whole whole(recorder);
  if (entries.empty()) return;
  // Requests arrive in whatever order the device ran; sorted, the slots are the same in every run.
  std::sort(entries.begin(), entries.end());
  const auto first_slot = static_cast<std::uint32_t>(blocks_.size());
  const auto slots = first_slot + static_cast<std::uint32_t>(entries.size());
  if (slots > capacity_) recorder.submit();  // into the pools that are left behind
  reserve(slots);
  const std::uint64_t bytes = sizeof(glm::ivec4) * entries.size();
  if (coordinates_.bytes() < bytes) coordinates_ = Buffer(device_, bytes * 3 / 2, Memory::Upload);
  const auto coordinates = coordinates_.as<glm::ivec4>();
  std::vector<TableEntry> written;
  std::vector<glm::ivec4> added;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const int e = static_cast<int>(entries[i]);
    const glm::ivec3 entry(e % table_size_.x, e / table_size_.x % table_size_.y,
                           e / table_size_.x / table_size_.y);
    added.emplace_back(table_origin_ + entry, 0);
    coordinates[i] = added.back();
    written.push_back({entries[i], first_slot + static_cast<std::uint32_t>(i)});
  }
  recorder.copy(coordinates_, block_buffer_, bytes, 0, sizeof(glm::ivec4) * first_slot);
  table_entries_.record(recorder, written, table_, request_table_);
  blocks_.insert(blocks_.end(), added.begin(), added.end());
  for (const TableEntry& at : written) table_mirror_[at.entry] = at.slot;
  block_count_ = static_cast<std::uint32_t>(blocks_.size()) - 1;
}

void Volume::clear() {
  const Recorder::Whole whole(recorder_);
  for (std::uint32_t chunk = 0; chunk < chunks_; ++chunk)
    for (int kind = 0; kind < (options_.colour ? 3 : 2); ++kind)
      recorder_.fill(pools_[kind][chunk], kEmptyWord[kind], 0, pools_[kind][chunk].bytes());
  std::vector<std::uint32_t> empty(table_mirror_.size(), 0);
  recordTable(empty, table_, request_table_);
  recorder_.submit();
  blocks_.resize(1);
  block_count_ = 0;
  table_mirror_ = std::move(empty);
}

void Volume::visibleBlocks(const glm::mat4& camera_from_world, glm::vec4 focal_centre, glm::ivec4 size,
                           float far, const DepthReach& reach, std::vector<std::uint32_t>& slots) const {
  const float side = kBlockSide * options_.voxel_size;
  const float radius = side * 0.8661f;  // half the diagonal
  const glm::mat3 rotation(camera_from_world);
  const glm::vec3 translation(camera_from_world[3]);
  // Half-spaces through the optical centre whose planes hold the image's edges; normals point inwards.
  const float left = (-0.5f - focal_centre.z) / focal_centre.x,
              right = (size.x - 0.5f - focal_centre.z) / focal_centre.x;
  float top = (-0.5f - focal_centre.w) / focal_centre.y,
        bottom = (size.y - 0.5f - focal_centre.w) / focal_centre.y;
  if (top > bottom) std::swap(top, bottom);  // negative fy
  const std::array<glm::vec3, 4> planes = {
      glm::normalize(glm::vec3(1, 0, -left)), glm::normalize(glm::vec3(-1, 0, right)),
      glm::normalize(glm::vec3(0, 1, -top)), glm::normalize(glm::vec3(0, -1, bottom))};
  slots.clear();
  for (std::uint32_t slot = 1; slot < blocks_.size(); ++slot) {
    const glm::vec3 centre = rotation * ((glm::vec3(blocks_[slot]) + 0.5f) * side) + translation;
    if (centre.z < -radius || centre.z > far + radius) continue;
    if (std::all_of(planes.begin(), planes.end(),
                    [&](const glm::vec3& n) { return glm::dot(n, centre) > -radius; }) &&
        !reach.hides(centre, radius, options_.truncation, focal_centre, size))
      slots.push_back(slot);
  }
}

VolumeContents Volume::download() {
  VolumeContents out;
  out.blocks = blocks_;
  out.tsdf.resize(blocks_.size() * kBlockVoxels);
  out.weight.resize(out.tsdf.size());
  out.colour.resize(options_.colour ? out.tsdf.size() : 0);
  for (std::uint32_t chunk = 0; chunk < chunks_; ++chunk) {
    const std::size_t first = std::size_t(chunk) << chunk_shift_;
    if (first >= blocks_.size()) break;  // a pool made for a growth that then failed
    const std::size_t slots = std::min<std::size_t>(blocks_.size() - first, std::size_t(1) << chunk_shift_);
    const auto fetch = [&](int kind) {
      Buffer mapped(device_, slots * kBlockBytes[kind], Memory::Readback);
      recorder_.copy(pools_[kind][chunk], mapped, slots * kBlockBytes[kind]);
      recorder_.submit();
      return mapped;
    };
    const std::size_t voxels = slots * kBlockVoxels, first_voxel = first * kBlockVoxels;
    const Buffer tsdf = fetch(0), weight = fetch(1);
    const auto t = tsdf.as<std::int16_t>();
    const auto w = weight.as<std::uint16_t>();
    for (std::size_t i = 0; i < voxels; ++i) {
      const std::size_t stored = storedIndex(i);
      out.tsdf[first_voxel + i] = std::max(-1.0f, t[stored] / 32767.0f);
      out.weight[first_voxel + i] = w[stored] / kWeightOne;
    }
    if (!options_.colour) continue;
    const Buffer colour = fetch(2);
    const auto c = colour.as<std::uint32_t>();
    for (std::size_t i = 0; i < voxels; ++i) out.colour[first_voxel + i] = c[storedIndex(i)];
  }
  return out;
}

}  // namespace rosefusion
