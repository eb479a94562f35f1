#include "engine/passes/allocate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rosefusion {
namespace {

using namespace shader;

constexpr std::uint32_t kCapacity = 1u << 16;  // requests listed at a time; a room's first view asks for about 5000
constexpr int kPixelStride = 2;                // two pixels are 1 cm apart at 3 m, well under a block
constexpr float kSamplesPerBlock = 4;          // along the ray

AllocateHeader emptyHeader() {
  constexpr int kMin = std::numeric_limits<int>::min(), kMax = std::numeric_limits<int>::max();
  return {0, 0, kMax, kMax, kMax, kMin, kMin, kMin};
}

}  // namespace

AllocatePass::AllocatePass(Device& device)
    : kernel_(device, shaderCode("allocate"), 4, sizeof(AllocateParams)),
      requests_(device, sizeof(AllocateHeader) + 4 * kCapacity, Memory::Readback) {}

void AllocatePass::record(Recorder& recorder, const Volume& volume, const PreprocessPass& frame, const CameraIntrinsics& camera,
                          const glm::mat4& world_from_camera) {
  requests_.as<AllocateHeader>()[0] = emptyHeader();
  AllocateParams params{};
  params.world_from_camera = world_from_camera;
  params.focal_centre = camera.focal_centre;
  // One voxel more than the truncation: trilinear lookups at its edge then find their neighbours.
  params.band = volume.options().truncation + volume.options().voxel_size;
  const float step = kBlockSide * volume.options().voxel_size / kSamplesPerBlock;
  params.size = glm::ivec4(camera.size.x, camera.size.y, kPixelStride, 1 + static_cast<int>(std::ceil(2 * params.band / step)));
  params.capacity = kCapacity;
  recorder.dispatch(kernel_, {&volume.layoutBuffer(), &volume.table(), &frame.depth(), &requests_}, params,
                    {std::uint32_t(camera.size.x + kPixelStride - 1) / kPixelStride,
                     std::uint32_t(camera.size.y + kPixelStride - 1) / kPixelStride});
}

bool AllocatePass::finish(Volume& volume) {
  const AllocateHeader header = requests_.as<AllocateHeader>()[0];
  const std::uint32_t listed = std::min(header.requested, kCapacity);
  const auto entries = requests_.as<std::uint32_t>().subspan(sizeof(AllocateHeader) / 4, listed);
  try {
    volume.addBlocks({entries.begin(), entries.end()});
    if (header.outside > 0)
      volume.cover({header.outside_min_x, header.outside_min_y, header.outside_min_z},
                   {header.outside_max_x, header.outside_max_y, header.outside_max_z});
    else if (header.requested > kCapacity)
      volume.clearRequests();
  } catch (...) {
    volume.clearRequests();
    throw;
  }
  return header.outside > 0 || header.requested > kCapacity;
}

}  // namespace rosefusion
