#include "engine/passes/allocate.h"

#include <cmath>
#include <limits>
#include <vector>

namespace rosefusion {
namespace {

using namespace shader;

constexpr int kPixelStride = 2;        // two pixels are 1 cm apart at 3 m, well under a block
constexpr float kSamplesPerBlock = 4;  // along the ray

std::uint32_t bindingsOn(const Device& device) {
  return device.info().readsTexels() ? kAllocateTexelBindings : kAllocateBindings;
}

AllocateHeader emptyHeader() {
  constexpr int kMin = std::numeric_limits<int>::min(), kMax = std::numeric_limits<int>::max();
  return {0, 0, kMax, kMax, kMax, kMin, kMin, kMin};
}

}  // namespace

AllocatePass::AllocatePass(Device& device, std::uint32_t capacity)
    : device_(device),
      kernel_(device, readerCode(device, "allocate"), bindingsOn(device), sizeof(AllocateParams)),
      capacity_(capacity),
      empty_(device, sizeof(AllocateHeader), Memory::Upload),
      requests_(device, sizeof(AllocateHeader) + 4ull * capacity, Memory::Readback) {
  empty_.as<AllocateHeader>()[0] = emptyHeader();
}

void AllocatePass::record(Recorder& recorder, const Volume& volume, const DeviceFrame& frame,
                          const CameraIntrinsics& camera, const glm::mat4& world_from_camera) {
  const Recorder::Whole whole(recorder);
  recorder.copy(empty_, requests_, sizeof(AllocateHeader));
  AllocateParams params{};
  params.world_from_camera = world_from_camera;
  params.focal_centre = camera.focal_centre;
  // One voxel more than the truncation: trilinear lookups at its edge then find their neighbours.
  params.band = volume.options().truncation + volume.options().voxel_size;
  const float step = kBlockSide * volume.options().voxel_size / kSamplesPerBlock;
  params.size = glm::ivec4(camera.size.x, camera.size.y, kPixelStride,
                           1 + static_cast<int>(std::ceil(2 * params.band / step)));
  params.capacity = capacity_;
  std::vector<BoundBuffers> buffers{volume.layoutBuffer(), volume.requestTable(), frame.depth, requests_};
  if (device_.info().readsTexels()) buffers.emplace_back(volume.requestTable());
  recorder.dispatchBytes(kernel_, buffers, &params, sizeof(params),
                         Threads{std::uint32_t(camera.size.x + kPixelStride - 1) / kPixelStride,
                                 std::uint32_t(camera.size.y + kPixelStride - 1) / kPixelStride});
}

bool AllocatePass::finish(Recorder& recorder, Volume& volume) {
  const AllocateHeader header = requests_.as<AllocateHeader>()[0];
  try {
    if (header.requested > capacity_) {
      // Which requests were listed depends on the order the device ran in; a list that holds all of them does
      // not.
      volume.restore();
      requests_ = Buffer(device_, sizeof(AllocateHeader) + 4ull * header.requested, Memory::Readback);
      capacity_ = header.requested;
      return true;
    }
    const auto entries = requests_.as<std::uint32_t>().subspan(sizeof(AllocateHeader) / 4, header.requested);
    volume.addBlocks(recorder, {entries.begin(), entries.end()});
    if (header.outside == 0) return false;
    recorder.submit();  // into the table that is left behind
    volume.cover({header.outside_min_x, header.outside_min_y, header.outside_min_z},
                 {header.outside_max_x, header.outside_max_y, header.outside_max_z});
  } catch (...) {
    volume.restore();
    throw;
  }
  return true;
}

}  // namespace rosefusion
