// Options for sequences small enough for tests: an eighth of the usual resolution, same field of view.
#pragma once
#include "host/synth/options.h"

namespace rosefusion::testing {

inline SynthOptions smallOptions(std::uint64_t seed = 1, int frames = 60) {
  SynthOptions options;
  options.seed = seed;
  options.frames = frames;
  options.intrinsics = {80, 60, 40, 40, 39.5, 29.5};
  return options;
}

}  // namespace rosefusion::testing
