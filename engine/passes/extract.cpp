#include "engine/passes/extract.h"

#include <cstring>
#include <limits>

#include "engine/error.h"
#include "engine/passes/marching_cubes.h"

namespace rosefusion {
namespace {

using namespace shader;

constexpr std::uint32_t kCountBatch = 16384;    // blocks
constexpr std::uint32_t kTriangles = 1u << 19;  // of an emitted batch
constexpr std::uint64_t kVertexBytes = sizeof(ExtractVertex) * kExtractVertices;
constexpr std::uint32_t kMaxSlots = std::numeric_limits<std::uint32_t>::max() / kBlockEdges;
static_assert(kExtractVertices >= kBlockEdges && kTriangles >= kBlockVoxels * kCaseTriangles,
              "one block must fit");

std::vector<std::uint32_t> caseTable() {
  std::vector<std::uint32_t> words(kCases * kCaseWords, 0);
  const auto cases = marchingCubesCases();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    std::uint32_t* row = &words[i * kCaseWords];
    for (const CellTriangle& t : cases[i]) row[++row[0]] = t[0] | t[1] << 4 | t[2] << 8;
  }
  return words;
}

}  // namespace

struct ExtractPass::Work {
  const Volume& volume;
  float min_weight;
  Recorder recorder;
  Buffer counts, listed, surface;
};

ExtractPass::ExtractPass(Device& device)
    : device_(device),
      count_(device, readerCode(device, "extract_count"), kExtractCountBindings, sizeof(ExtractCountParams)),
      emit_(device, readerCode(device, "extract_emit"), kExtractEmitBindings, sizeof(ExtractEmitParams)) {
  const auto words = caseTable();
  cases_ = Buffer(device, 4 * words.size(), Memory::Upload);
  std::memcpy(cases_.as<char>().data(), words.data(), 4 * words.size());
}

void ExtractPass::count(Work& work, std::uint32_t first_slot, std::uint32_t blocks) {
  const ExtractCountParams params{first_slot, blocks, work.min_weight, 0};
  const Volume& volume = work.volume;
  work.recorder.dispatch(count_.of(volume.chunks()),
                         {volume.layoutBuffer(), volume.table(), volume.blockBuffer(), volume.tsdf(),
                          volume.weight(), cases_, work.counts},
                         params, Groups{blocks});
  work.recorder.submit();
}

void ExtractPass::emit(Work& work, std::span<const ExtractBlock> listed) {
  std::memcpy(work.listed.as<char>().subspan(cases_.bytes()).data(), listed.data(), listed.size_bytes());
  const Volume& volume = work.volume;
  const ExtractEmitParams params{static_cast<std::uint32_t>(listed.size()), work.min_weight,
                                 volume.options().colour, 0};
  work.recorder.dispatch(emit_.of(volume.chunks()),
                         {volume.layoutBuffer(), volume.table(), volume.blockBuffer(), volume.tsdf(),
                          volume.weight(), volume.colour(), work.listed, work.surface},
                         params, Groups{static_cast<std::uint32_t>(listed.size())});
  work.recorder.submit();
}

void ExtractPass::run(const Volume& volume, float min_weight,
                      const std::function<void(const ExtractBatch&)>& take) {
  const auto slots = static_cast<std::uint32_t>(volume.blocks().size());
  if (slots > kMaxSlots)
    throw DeviceError(DeviceErrorCode::OutOfMemory,
                      "The volume has too many blocks for one mesh; make volume.voxel_size larger.");
  Work work{volume,
            min_weight,
            Recorder(device_),
            Buffer(device_, sizeof(ExtractCount) * kCountBatch, Memory::Readback),
            Buffer(device_, cases_.bytes() + sizeof(ExtractBlock) * kCountBatch, Memory::Upload),
            Buffer(device_, kVertexBytes + 12ull * kTriangles, Memory::Readback)};
  std::memcpy(work.listed.as<char>().data(), cases_.as<char>().data(), cases_.bytes());
  std::vector<ExtractBlock> listed;
  std::uint32_t vertices = 0, triangles = 0;
  const auto flush = [&] {
    if (listed.empty()) return;
    emit(work, listed);
    take({listed, work.surface.as<ExtractVertex>().first(vertices),
          work.surface.as<std::uint32_t>().subspan(kVertexBytes / 4, 3ull * triangles)});
    listed.clear();
    vertices = triangles = 0;
  };
  for (std::uint32_t first = 1; first < slots; first += kCountBatch) {
    const std::uint32_t blocks = std::min(kCountBatch, slots - first);
    count(work, first, blocks);
    const auto counts = work.counts.as<ExtractCount>();
    for (std::uint32_t i = 0; i < blocks; ++i) {
      const ExtractCount counted = counts[i];
      if (counted.vertices == 0 && counted.triangles == 0) continue;
      if (vertices + counted.vertices > kExtractVertices || triangles + counted.triangles > kTriangles)
        flush();
      listed.push_back({first + i, vertices, triangles, 0});
      vertices += counted.vertices;
      triangles += counted.triangles;
    }
    flush();
  }
}

}  // namespace rosefusion
