// Single frames, searched again and again: the model is fused at the true poses up to the frame before, and
// every search starts from that frame's true pose, so that methods differ by nothing but their search.
#pragma once
#include <functional>

#include "engine/device_frame.h"
#include "engine/passes/allocate.h"
#include "engine/passes/integrate.h"
#include "host/experiments/sequences.h"
#include "host/slam/baselines/pose_methods.h"

namespace rosefusion {

/// One frame on the device, and the model of those before it.
struct StudiedFrame {
  std::size_t index = 0;
  const DeviceFrame& frame;
  const Volume& volume;
  Pose last, truth;  ///< world_from_camera of the frame before and of this one
};

/// Calls `study` for every `every`-th frame from `first` on. `world_from_truth` turns the world's axes.
/// Throws Interrupted through `study`.
void studyFrames(const ExperimentContext& context, const Settings& settings, const MemorySequence& sequence,
                 std::size_t first, std::size_t every, const Pose& world_from_truth,
                 const std::function<void(const StudiedFrame&)>& study);

/// What a method did in one iteration, or before the first (iteration 0).
struct SearchState {
  Pose best = Pose::Identity();
  std::array<double, 5> fitness{};  ///< of the particles: least, quartiles, most; NaN of methods without any
};

/// One of the methods, from frame to frame. Throws as Pipeline for settings that do not go together.
class StudiedMethod {
 public:
  StudiedMethod(Device& device, const Settings& settings, const Intrinsics& intrinsics);

  /// The states before the first iteration and after each of swarm.max_iterations.
  std::vector<SearchState> search(const StudiedFrame& studied);
  /// 1 - residual of the pose over the overlap with the last frame; every 8th pixel, whatever the method
  /// looks at.
  double fitness(const StudiedFrame& studied, const Pose& pose);
  void search(const StudiedFrame& studied, const SearchObserver& observer);

 private:
  const Settings settings_;
  SwarmSearch swarm_;
  PoseRefiner refiner_;
  std::unique_ptr<PoseMethod> method_;
};

}  // namespace rosefusion
