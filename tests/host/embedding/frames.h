// The short generated sequence as a caller of the public headers has it.
#pragma once
#include <cstdlib>

#include "rosefusion/reconstructor.h"
#include "tests/host/slam/short_sequence.h"

namespace rosefusion::testing {

inline Camera publicCamera(const SynthSequence& sequence = shortSequence()) {
  const Intrinsics& k = sequence.intrinsics;
  return {k.width, k.height, k.fx, k.fy, k.cx, k.cy, sequence.depth_units_per_metre};
}

inline DepthFrame publicFrame(std::size_t i, const SynthSequence& sequence = shortSequence()) {
  const Frame& frame = sequence.frames[i];
  return {{frame.depth.ptr<std::uint16_t>(), frame.depth.total()}, frame.timestamp, {}};
}

/// quickSettings() by key and value.
inline Options quickOptions() {
  Options options;
  options.preset = "paper";
  options.settings = {{"swarm.levels", "1024/16 512/8 256/4"},
                      {"tracking.templates_per_level", "3"},
                      {"volume.voxel_size", "0.03"},
                      {"volume.truncation", "0.09"}};
  return options;
}

/// The same on the device under test, with larger voxels and one level of particles.
inline Options coarseOptions() {
  Options options = quickOptions();
  options.device = std::getenv("ROSEFUSION_DEVICE") ? std::getenv("ROSEFUSION_DEVICE") : "llvmpipe";
  options.settings[0].value = "512/8";
  options.settings[2].value = "0.06";
  options.settings[3].value = "0.18";
  return options;
}

}  // namespace rosefusion::testing
