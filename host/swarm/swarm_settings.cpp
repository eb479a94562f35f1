#include "host/swarm/swarm_settings.h"

#include <string>

#include "host/core/error.h"

namespace rosefusion {

SwarmSettings paperSwarmSettings() {
  return {};
}

SwarmSettings releaseSwarmSettings() {
  SwarmSettings settings;
  settings.loss = FitnessLoss::Absolute;
  settings.max_advantage_particles = 200;
  settings.axis_scale = 0.09;
  settings.empty_set_scale = 0.18;  // inferred: twice axis_scale, as the first length is
  settings.first_axis_scale = 0.18;
  settings.frame_start = FrameStart::FailureLoss;
  return settings;
}

void requireValid(const SwarmSettings& s) {
  const auto require = [](bool holds, const char* field, const char* range) {
    if (!holds) throw InputError(std::string("swarm.") + field + " is out of range; choose " + range + ".");
  };
  // Written so that NaN fails too.
  require(s.tau > 0 && s.tau < 1e6, "tau", "a value above 0");
  require(s.minimum_counted_share >= 0 && s.minimum_counted_share < 1, "minimum_counted_share",
          "0 up to below 1");
  require(s.max_advantage_particles >= 0, "max_advantage_particles", "0 (all) or more");
  require(s.axis_scale > 0 && s.axis_scale <= 10, "axis_scale", "a value above 0, up to 10");
  require(s.axis_epsilon >= 0 && s.axis_epsilon <= 1, "axis_epsilon", "0 to 1");
  require(s.axis_momentum >= 0 && s.axis_momentum < 1, "axis_momentum", "0 up to below 1");
  require(s.empty_set_scale > 0 && s.empty_set_scale <= 10, "empty_set_scale", "a value above 0, up to 10");
  require(s.initial_likelihood >= 0 && s.initial_likelihood < 1, "initial_likelihood", "0 up to below 1");
  require(s.first_axis_scale > 0 && s.first_axis_scale <= 10, "first_axis_scale",
          "a value above 0, up to 10");
  require(!s.levels.empty(), "levels", "at least one level");
  for (const SwarmLevel& level : s.levels) {
    require(level.particles >= 32 && level.particles <= 200000, "levels.particles", "32 to 200000");
    require(level.pixel_stride >= 1 && level.pixel_stride <= 256, "levels.pixel_stride", "1 to 256");
  }
  require(s.pixel_shift >= 0, "pixel_shift", "0 or more");
  require(s.max_iterations >= 1, "max_iterations", "1 or more");
  require(s.max_empty_sets >= 1, "max_empty_sets", "1 or more");
  require(s.minimum_move >= 0 && s.minimum_move < 1, "minimum_move", "0 up to below 1");
}

}  // namespace rosefusion
