// What the passes are timed on: a generated sequence, fused with its true poses.
#pragma once
#include <vector>

#include "engine/passes/allocate.h"
#include "engine/passes/integrate.h"
#include "engine/passes/preprocess.h"
#include "engine/passes/select_points.h"
#include "host/bench/native_integrate.h"
#include "host/bench/native_preprocess.h"
#include "host/bench/pass_bench.h"
#include "host/synth/sequence.h"

namespace rosefusion {

/// The frames, the volume, and the passes that fill it. Frames are told by their number.
class BenchScene {
 public:
  BenchScene(Device& device, const BenchOptions& options);

  std::size_t frames() const { return sequence_.frames.size(); }
  const Pose& truth(std::size_t frame) const { return sequence_.truth[frame].world_from_camera; }
  const shader::CameraIntrinsics& camera() const { return camera_; }
  Recorder& recorder() { return recorder_; }
  Volume& volume() { return volume_; }
  const DeviceFrame& frame() const { return frame_.frame(); }
  float truncation() const { return volume_.options().truncation; }

  /// Preprocesses a frame, with all that the settings ask for.
  void load(std::size_t i);
  void allocateBlocks(std::size_t i);
  /// Of the frame that was loaded last.
  void integrate(std::size_t i);
  /// Depths of a frame as the camera gives them.
  std::span<const std::uint16_t> raw(std::size_t i) const;
  NativePreprocessing preprocessing() const;
  NativeFusion fusion(std::size_t i) const;
  /// Slots of the blocks that integrate() updates.
  void visibleBlocks(std::size_t i, std::vector<std::uint32_t>& slots) const;
  /// Selects them on the device, and copies them.
  std::vector<glm::vec4> selectPoints(SelectPointsPass& select, int stride);
  template <typename T>
  std::vector<T> fetch(const Buffer& buffer, std::size_t number) {
    const Buffer mapped(device_, sizeof(T) * std::max<std::size_t>(number, 1), Memory::Readback);
    recorder_.copy(buffer, mapped, mapped.bytes());
    recorder_.submit();
    const auto values = mapped.as<T>().first(number);
    return {values.begin(), values.end()};
  }

 private:
  float farthest() const;

  Device& device_;
  const BenchOptions& options_;
  const SynthSequence sequence_;
  const shader::CameraIntrinsics camera_;
  Recorder recorder_;
  Volume volume_;
  PreprocessPass frame_;
  AllocatePass allocate_;
  IntegratePass integrate_;
};

}  // namespace rosefusion
