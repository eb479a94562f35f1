// Everything a generated sequence depends on.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "host/core/camera.h"
#include "host/synth/scene.h"
#include "host/synth/sensors.h"
#include "host/synth/timing.h"

namespace rosefusion {

enum class Motion {
  kSixDof,    ///< free flight through the room, turning
  kLinear,    ///< back and forth on a straight line, no rotation
  kRotation,  ///< on the spot
  kReplay,    ///< a recorded trajectory
  kAround,    ///< by hand around a desk, or in full turns around an object
};

enum class SceneKind { kRoom, kDesk, kObject };

enum class DepthNoise {
  kNone,
  kHanda,      ///< as published, without bias; see addHandaNoise
  kSimkinect,  ///< rounded as the program simkinect does: reads z^2 / 702.6 m too near
};
/// "none", "handa", "simkinect".
const char* toString(DepthNoise noise);
/// Throws InputError for another word.
DepthNoise depthNoiseFrom(const std::string& word);

/// The defaults are the default sequence: 8 s of the paper's FastCaMo-Synth recipe (section 5.1, table 1).
struct SynthOptions {
  std::uint64_t seed = 1;  ///< of the room, the motion and the noise
  SceneKind scene = SceneKind::kRoom;
  std::filesystem::path mesh_file;  ///< empty: a procedural scene
  UpAxis up = UpAxis::kGuess;       ///< of mesh_file

  Motion motion = Motion::kSixDof;
  int frames = 240;
  double fps = 30;
  SpeedRange linear{1.0, 1.68, 4.0};   ///< m/s
  SpeedRange angular{0.4, 0.95, 2.2};  ///< rad/s
  double ramp = 0.3;                   ///< seconds from rest to the range's lower end
  int loops = 0;  ///< above 0 (kSixDof): this many laps of one closed tour through all rooms
  double turn_per_frame = 2.5 * 3.14159265358979 / 180;  ///< radians (kAround an object); 0: as linear says
  bool cut_out = false;                                  ///< kObject: what is not the object has no depth
  std::filesystem::path replay_file;                     ///< TUM trajectory (kReplay)
  double replay_speed = 1;                               ///< times faster than recorded (kReplay)

  Sensor sensor;  ///< other than kinect1: its images and range, instead of intrinsics, max_depth and noise
  Intrinsics intrinsics{640, 480, 320, 320, 319.5, 239.5};
  double max_depth = 10;  ///< metres; further reads 0
  DepthNoise noise = DepthNoise::kHanda;
  bool colour = false;
  int threads = 0;  ///< 0: one per core; the result does not depend on it
};

/// Throws InputError naming the first setting that makes no sense.
void requirePlausible(const SynthOptions& options);

}  // namespace rosefusion
