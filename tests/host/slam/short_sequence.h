// A short generated sequence, small enough for a test and fast enough to be worth tracking.
#pragma once
#include "host/settings/settings.h"
#include "host/synth/sequence.h"
#include "tests/host/synth/rooms.h"

namespace rosefusion::testing {

inline SynthSequence makeShortSequence(std::uint64_t seed, int frames) {
  SynthOptions options;
  options.seed = seed;
  options.frames = frames;
  options.intrinsics = {320, 240, 160, 160, 159.5, 119.5};
  return makeSequence(options);
}

inline const SynthSequence& shortSequence() {
  static const SynthSequence sequence = makeShortSequence(kAnyRoom, 16);
  return sequence;
}

/// Distance between an estimated position and the truth, both relative to the first frame.
inline double errorAt(std::size_t i, const Pose& estimate, const SynthSequence& sequence = shortSequence()) {
  const Pose truth = sequence.truth[0].world_from_camera.inverse() * sequence.truth[i].world_from_camera;
  return (truth.translation() - estimate.translation()).norm();
}

/// The paper's search with fewer particles: a frame takes milliseconds instead of a third of a second.
inline Settings quickSettings() {
  Settings settings = loadSettings("paper");
  applyAssignment(settings, "swarm.levels=1024/16 512/8 256/4");
  applyAssignment(settings, "tracking.templates_per_level=3");
  applyAssignment(settings, "volume.voxel_size=0.03");
  applyAssignment(settings, "volume.truncation=0.09");
  return settings;
}

}  // namespace rosefusion::testing
