#include "host/synth/options.h"

#include <cmath>
#include <sstream>

#include "host/core/error.h"
#include "host/core/number_text.h"

namespace rosefusion {
namespace {

void requireWithin(double value, double low, double high, const char* setting, const char* unit) {
  if (std::isfinite(value) && value >= low && value <= high) return;
  TextStream text;
  text << setting << ": " << value << " makes no sequence; give " << low << " to " << high << unit << ".";
  throw InputError(text.str());
}

void requireOrdered(const SpeedRange& range, const char* what, const char* low, const char* mean,
                    const char* high) {
  if (range.low <= range.mean && range.mean <= range.high) return;
  TextStream text;
  text << "The " << what << " speeds must ascend, but " << low << " is " << range.low << ", " << mean
       << " is " << range.mean << " and " << high << " is " << range.high << "; change one of them.";
  throw InputError(text.str());
}

}  // namespace

const char* toString(DepthNoise noise) {
  switch (noise) {
    case DepthNoise::Handa:
      return "handa";
    case DepthNoise::Simkinect:
      return "simkinect";
    case DepthNoise::None:
      break;
  }
  return "none";
}

DepthNoise depthNoiseFrom(const std::string& word) {
  for (const DepthNoise noise : {DepthNoise::None, DepthNoise::Handa, DepthNoise::Simkinect})
    if (word == toString(noise)) return noise;
  throw InputError("--noise: there is no depth noise '" + word + "'; give handa, simkinect or none.");
}

void requirePlausible(const SynthOptions& o) {
  requireWithin(o.frames, 2, 1000000, "--frames", "");
  requireWithin(o.fps, 1, 1000, "--fps", " frames a second");
  requireWithin(o.linear.high, 0.05, 20, "--max-speed", " m/s");
  requireWithin(o.linear.mean, 0.05, 20, "--speed", " m/s");
  requireWithin(o.linear.low, 0, 20, "--min-speed", " m/s");
  requireWithin(o.angular.mean, 0, 20, "--angular", " rad/s");
  requireWithin(o.angular.high, 0, 20, "--max-angular", " rad/s");
  requireOrdered(o.linear, "linear", "--min-speed", "--speed", "--max-speed");
  requireOrdered(o.angular, "angular", "the least", "--angular", "--max-angular");
  requireWithin(o.ramp, 0, 10, "--ramp", " s");
  requireWithin(o.loops, 0, 1000, "--loops", " laps");
  requireWithin(o.max_depth, 0.5, 13, "--max-depth", " m (16-bit PNGs at 5000 a metre end at 13.1 m)");
  requireWithin(o.replay_speed, 0.05, 50, "--replay-speed", "");
  requirePlausible(o.intrinsics, "camera settings");
  if ((o.motion == Motion::Around) != (o.scene != SceneKind::Room) ||
      (o.scene != SceneKind::Room && !o.mesh_file.empty()))
    throw InputError(
        "--scene desk and object have their own surfaces and motion; leave out --mesh, --motion and "
        "--replay.");
  if (o.cut_out && o.scene != SceneKind::Object)
    throw InputError("--cut-out needs a thing to cut out; give --scene object.");
  requireWithin(o.turn_per_frame, 0, 1, "the turn of a frame", " rad");
  if (o.motion == Motion::Replay && o.replay_file.empty())
    throw InputError("--motion replay needs a recorded trajectory; name it with --replay FILE.");
}

}  // namespace rosefusion
