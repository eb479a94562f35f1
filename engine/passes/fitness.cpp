#include "engine/passes/fitness.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "engine/error.h"

namespace rosefusion {
namespace {

using namespace shader;

// A wide GPU needs about this many invocations in flight, a CPU just its cores' vector lanes: there one
// invocation walks all the points of a particle, which keeps the compensated sum in registers.
// An H100 is fastest with 32 to 48 thousand: more spend their time on the particles' poses.
constexpr std::uint32_t kWideInvocations = 40u << 10;
constexpr std::uint32_t kMaxSlices = 128;

std::uint32_t slicesFor(const DeviceInfo& device, std::uint32_t particles) {
  if (device.type == DeviceType::Cpu) return 1;
  return std::clamp(kWideInvocations * kFitnessParticles / std::max(particles, 1u), 1u, kMaxSlices);
}

}  // namespace

FitnessPass::FitnessPass(Device& device, std::span<const glm::vec4> templates, Loss loss, bool compensate,
                         std::uint32_t slices)
    : device_(device),
      loss_(loss),
      compensate_(compensate),
      slices_(slices),
      kernels_(device, readerCode(device, "fitness"), kFitnessBindings, sizeof(FitnessParams)),
      reduce_(device, shaderCode("fitness_reduce"), 4, sizeof(FitnessReduceParams)) {
  overlap_ = Buffer(device, sizeof(OverlapView), Memory::Upload);
  setTemplates(templates);
}

void FitnessPass::setTemplates(std::span<const glm::vec4> templates) {
  if (templates_.bytes() < templates.size_bytes())
    templates_ = Buffer(device_, templates.size_bytes(), Memory::Device);
  Buffer stage(device_, templates.size_bytes(), Memory::Upload);
  std::memcpy(stage.as<char>().data(), templates.data(), templates.size_bytes());
  Recorder recorder(device_);
  recorder.copy(stage, templates_, templates.size_bytes());
  recorder.submit();
}

void FitnessPass::prepare(const VolumeView& volume, bool overlap_per_particle, bool racing) {
  kernel(volume, overlap_per_particle, racing && (slices_ ? slices_ : slicesFor(device_.info(), 1)) == 1);
}

std::uint64_t FitnessPass::lookups() const {
  const auto walked = walked_.as<std::uint32_t>().first(particles_);
  if (!raced_) return std::uint64_t(particles_) * walked[0];  // all walk the same points
  return std::accumulate(walked.begin(), walked.end(), std::uint64_t(0));
}

void FitnessPass::record(Recorder& recorder, const Volume& volume, const SelectPointsPass& points,
                         const SwarmPlacement& swarm, const LastView* last_view) {
  const Recorder::Whole whole(recorder);
  if (32ull * (swarm.first_particle + swarm.particles) > templates_.bytes())
    throw DeviceError(DeviceErrorCode::Programming, "The swarm reaches past the templates on the device.");
  particles_ = swarm.particles;
  const std::uint32_t slices = std::max((points.cells() + kLongestLoop - 1) / kLongestLoop,
                                        slices_ ? slices_ : slicesFor(device_.info(), swarm.particles));
  if (partial_.bytes() < 16ull * slices * swarm.particles)
    partial_ = Buffer(device_, 16ull * slices * swarm.particles, Memory::Device);
  if (loss_buffer_.bytes() < 4ull * swarm.particles)
    loss_buffer_ = Buffer(device_, 4ull * swarm.particles, Memory::Readback);
  if (counted_.bytes() < 4ull * swarm.particles)
    counted_ = Buffer(device_, 4ull * swarm.particles, Memory::Readback);
  if (walked_.bytes() < 4ull * swarm.particles)
    walked_ = Buffer(device_, 4ull * swarm.particles, Memory::Readback);
  if (last_view) {
    const glm::vec4 f = last_view->camera.focal_centre;
    const glm::mat4 image_from_camera(f.x, 0, 0, 0, 0, f.y, 0, 0, f.z, f.w, 1, 0, 0, 0, 0, 1);
    overlap_.as<OverlapView>()[0] = {image_from_camera * last_view->camera_from_world,
                                     last_view->camera.size};
  }

  // One slice cannot give a particle up for the others: their sums would stand for different points.
  raced_ = swarm.race_margin > 0 && slices == 1;
  const FitnessParams params{swarm.world_from_camera, swarm.translation_lengths, swarm.rotation_lengths,
                             swarm.particles,         swarm.first_particle,      slices,
                             swarm.race_margin};
  recorder.dispatch(kernel(volume, last_view != nullptr, raced_),
                    {volume.layoutBuffer(), volume.table(), volume.tsdf(), templates_, points.points(),
                     points.count(), partial_, overlap_},
                    params, Threads{(swarm.particles + kFitnessParticles - 1) / kFitnessParticles, slices});
  recorder.dispatch(reduce_, {partial_, loss_buffer_, counted_, walked_},
                    FitnessReduceParams{swarm.particles, slices}, Threads{swarm.particles});
}

}  // namespace rosefusion
