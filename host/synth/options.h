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
  SixDof,    ///< free flight through the room, turning
  Linear,    ///< back and forth on a straight line, no rotation
  Rotation,  ///< on the spot
  Replay,    ///< a recorded trajectory
  Around,    ///< by hand around a desk, or in full turns around an object
};

enum class SceneKind { Room, Desk, Object };

enum class DepthNoise {
  None,
  Handa,      ///< as published, without bias; see addHandaNoise
  Simkinect,  ///< rounded as the program simkinect does: reads z^2 / 702.6 m too near
};
/// "none", "handa", "simkinect".
const char* toString(DepthNoise noise);
/// Throws InputError for another word.
DepthNoise depthNoiseFrom(const std::string& word);

/// The defaults are the default sequence: 8 s of the paper's FastCaMo-Synth recipe (section 5.1, table 1).
struct SynthOptions {
  std::uint64_t seed = 1;  ///< of the room, the motion and the noise
  SceneKind scene = SceneKind::Room;
  std::filesystem::path mesh_file;  ///< empty: a procedural scene
  UpAxis up = UpAxis::Guess;        ///< of mesh_file

  Motion motion = Motion::SixDof;
  int frames = 240;
  double fps = 30;
  SpeedRange linear{1.0, 1.68, 4.0};   ///< m/s
  SpeedRange angular{0.4, 0.95, 2.2};  ///< rad/s
  double ramp = 0.3;                   ///< seconds from rest to the range's lower end
  int loops = 0;  ///< above 0 (SixDof): this many laps of one closed tour through all rooms
  double turn_per_frame = 2.5 * 3.14159265358979 / 180;  ///< radians (Around an object); 0: as linear says
  bool cut_out = false;                                  ///< Object: what is not the object has no depth
  std::filesystem::path replay_file;                     ///< TUM trajectory (Replay)
  double replay_speed = 1;                               ///< times faster than recorded (Replay)

  Sensor sensor;  ///< other than kinect1: its images and range, instead of intrinsics, max_depth and noise
  Intrinsics intrinsics{640, 480, 320, 320, 319.5, 239.5};
  double max_depth = 10;  ///< metres; further reads 0
  DepthNoise noise = DepthNoise::Handa;
  bool colour = false;
  int threads = 0;  ///< 0: one per core; the result does not depend on it
};

/// Throws InputError naming the first setting that makes no sense.
void requirePlausible(const SynthOptions& options);

}  // namespace rosefusion
