// rosefusion synth: makes a sequence with known truth.

#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli/commands.h"
#include "apps/cli/exit_code.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/progress.h"
#include "host/core/error.h"
#include "host/synth/tum_writer.h"

namespace rosefusion::cli {
namespace {

constexpr int kAllFrames = 1000000;  // of a recording, which ends earlier

struct Arguments {
  SynthOptions options;
  std::filesystem::path out;
  std::optional<double> low, mean, high, angular_mean, angular_high, cx, cy;
  bool force = false, frames_given = false, motion_given = false;
  std::string json, up = "guess", motion = "6d", noise = "handa", sensor = "kinect1", registered,
                    scene = "room";
  std::vector<std::pair<CLI::Option*, std::string>> of_motions;  // options, and the motions that heed them
  std::vector<CLI::Option*> of_free_camera;                      // of a camera that no sensor describes
  CLI::Option* fps = nullptr;
};

void refuseIgnored(const Arguments& a) {
  const bool replay = !a.options.replay_file.empty();
  const bool around = a.scene != "room";
  const std::string motion = replay ? "replay" : around ? "around" : a.motion;
  if (replay && a.motion_given && a.motion != "replay")
    throw InputError("--motion " + a.motion +
                     ": --replay flies a recording as it is; leave out one of them.");
  if (around && (replay || a.motion_given))
    throw InputError("--scene " + a.scene + " has its own motion; leave out --motion and --replay.");
  for (const auto& [option, motions] : a.of_motions)
    if (option->count() > 0 && motions.find(motion) == std::string::npos)
      throw InputError(option->get_name() + " means nothing to " +
                       (replay   ? "--replay, which flies a recording as it is"
                        : around ? "--scene " + a.scene
                                 : "--motion " + motion) +
                       "; leave it out.");
}

/// Another sensor than kinect1 brings its own images, range and rate.
void chooseSensor(Arguments& a) {
  a.options.sensor = sensorNamed(a.sensor);
  Sensor& sensor = a.options.sensor;
  if (sensor.principle == DepthPrinciple::Noise) {
    if (!a.registered.empty() && a.registered != "none")
      throw InputError(
          "--registered means nothing to --sensor kinect1, whose depth is the colour camera's; leave it "
          "out.");
    return;
  }
  for (const CLI::Option* option : a.of_free_camera)
    if (option->count() > 0)
      throw InputError(option->get_name() + ": --sensor " + a.sensor +
                       " is one camera as it is; leave it out.");
  if (!a.registered.empty()) sensor.registration = registrationFrom(a.registered);
  if (sensor.registration != Registration::None && sensor.colour.width == 0)
    throw InputError("--registered: the depth of --sensor " + a.sensor +
                     " is the colour camera's already; leave it out.");
  if (a.fps->count() == 0) a.options.fps = sensor.fps;
  a.options.intrinsics = sensor.output();
}

/// A desk is looked at more slowly than a room, an object by 2.5 degrees a frame unless a speed is given.
void chooseScene(Arguments& a) {
  a.options.scene = a.scene == "desk"     ? SceneKind::Desk
                    : a.scene == "object" ? SceneKind::Object
                                          : SceneKind::Room;
  if (a.scene == "room") return;
  a.options.linear = {0.15, 0.5, 0.9};
  if (a.mean || a.low || a.high) a.options.turn_per_frame = 0;
  if (a.scene == "object" && !a.frames_given)
    a.options.frames = 145;  // one turn, and its first view once more
}

/// Speeds left out follow those given, in the proportions of the defaults.
void settle(Arguments& a) {
  SpeedRange& linear = a.options.linear;
  const SpeedRange usual = linear;
  if (!a.high && a.mean && *a.mean > 0.8 * usual.high) a.high = *a.mean * usual.high / usual.mean;
  linear = usual.endingAt(a.high.value_or(usual.high));
  if (a.mean) {
    linear.mean = *a.mean;
    linear.low = std::min(linear.low, linear.mean * usual.low / usual.mean);
  }
  // A floor that was raised raises the mean with it.
  if (a.low && !a.mean) linear.mean = std::max(linear.mean, *a.low + 0.25 * (linear.high - *a.low));
  linear.low = a.low.value_or(linear.low);
  SpeedRange& angular = a.options.angular;
  const SpeedRange usual_turn = angular;
  if (!a.angular_high && a.angular_mean && *a.angular_mean > 0.8 * usual_turn.high)
    a.angular_high = *a.angular_mean * usual_turn.high / usual_turn.mean;
  angular = usual_turn.endingAt(a.angular_high.value_or(usual_turn.high));
  if (a.angular_mean) {
    angular.mean = *a.angular_mean;
    angular.low = std::min(angular.low, angular.mean * usual_turn.low / usual_turn.mean);
  }
  Intrinsics& k = a.options.intrinsics;
  k.cx = a.cx.value_or((k.width - 1) / 2.0);
  k.cy = a.cy.value_or((k.height - 1) / 2.0);
  const std::map<std::string, Motion> motions{{"6d", Motion::SixDof},
                                              {"linear", Motion::Linear},
                                              {"rotation", Motion::Rotation},
                                              {"replay", Motion::Replay}};
  const std::map<std::string, UpAxis> axes{{"guess", UpAxis::Guess}, {"y", UpAxis::Y}, {"z", UpAxis::Z}};
  a.options.motion = a.options.replay_file.empty() ? motions.at(a.motion) : Motion::Replay;
  if (a.scene != "room") a.options.motion = Motion::Around;
  a.options.up = axes.at(a.up);
  a.options.noise = depthNoiseFrom(a.noise);
  if (a.options.motion == Motion::Replay && !a.frames_given) a.options.frames = kAllFrames;
}

void run(Arguments& a) {
  refuseIgnored(a);
  chooseScene(a);
  settle(a);
  chooseSensor(a);
  requirePlausible(a.options);
  requireUsableOutput(a.out, a.force);
  requireWritableJson(a.json);
  std::fprintf(stderr, "building the scene and planning the motion\n");
  const SynthPlan plan(a.options);
  if (a.frames_given && static_cast<int>(plan.truth().size()) < a.options.frames)
    std::fprintf(stderr, "the recording ends after %zu frames\n", plan.truth().size());
  catchInterrupts();
  try {
    Progress progress("frames");
    writeTumSequence(a.out, plan, a.force, [&](int done, int total) {
      if (interrupted()) throw ExitCode(kExitInterrupted);
      progress.update(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
    });
  } catch (const ExitCode&) {
    spdlog::warn("Interrupted; nothing of the sequence is kept.");
    throw;
  }
  const MotionStatistics s = plan.statistics();
  if (a.json != "-")
    std::printf(
        "%s: %zu frames, %.1f s, %.1f m\n"
        "  linear  mean %.2f  max %.2f m/s\n  angular mean %.2f  max %.2f rad/s\n  never closer than %.2f m "
        "to a surface\n",
        a.out.c_str(), plan.truth().size(), plan.truth().back().timestamp, s.length, s.linear_mean,
        s.linear_max, s.angular_mean, s.angular_max, s.clearance);
  if (const Eigen::Vector3d& o = plan.scene().origin; !o.isZero())
    spdlog::info(
        "The mesh lies far from its origin; the sequence's world begins at ({:.0f}, {:.0f}, {:.0f}) m of it.",
        o.x(), o.y(), o.z());
  writeJson(a.json, synthReport(plan));
}

}  // namespace

void addSynthCommand(CLI::App& app) {
  auto a = std::make_shared<Arguments>();
  CLI::App* c = app.add_subcommand(
      "synth", "Make a depth sequence with known truth, from a procedural room or a mesh.");
  c->add_option("OUT_DIR", a->out, "folder to make (TUM RGB-D layout)")->required();
  c->add_option("--seed", a->options.seed, "of the room, the motion and the noise")->capture_default_str();
  c->add_option("--frames", a->options.frames,
                "number of frames; replay: at most, all of the recording when left out")
      ->capture_default_str()
      ->each([a](const std::string&) { a->frames_given = true; });
  a->fps = c->add_option("--fps", a->options.fps, "frames a second")->capture_default_str();
  c->add_flag("--force", a->force, "replace a sequence generated earlier");
  c->add_option("--json", a->json, "write the report (synth.json) to this file too; - for standard output");
  c->add_option("--threads", a->options.threads, "0: one per core; the result does not depend on it")
      ->check(CLI::Range(0, 1024));

  c->add_option("--scene", a->scene,
                "room, desk (a table top with things, from 0.3 to 1.2 m by hand) or object (one thing of 0.2 "
                "to 0.6 m, "
                "in full turns of 2.5 degrees a frame, or at --speed)")
      ->check(CLI::IsMember({"room", "desk", "object"}))
      ->capture_default_str()
      ->group("Scene");
  c->add_flag("--cut-out", a->options.cut_out, "object: depth 0 wherever something else is seen")
      ->group("Scene");
  c->add_option("--mesh", a->options.mesh_file,
                "closed room or building in metres (PLY, OBJ, STL, glTF) instead of the procedural room")
      ->group("Scene");
  c->add_option("--up", a->up, "up axis of the mesh")
      ->check(CLI::IsMember({"guess", "y", "z"}))
      ->capture_default_str()
      ->group("Scene");

  const auto of = [&](const char* motions, CLI::Option* option) {
    a->of_motions.emplace_back(option->group("Motion"), motions);
  };
  c->add_option("--motion", a->motion,
                "free flight, to and fro on a line, turning on the spot, or a recording")
      ->check(CLI::IsMember({"6d", "linear", "rotation", "replay"}))
      ->capture_default_str()
      ->group("Motion")
      ->each([a](const std::string&) { a->motion_given = true; });
  of("6d linear around",
     c->add_option("--speed", a->mean, "mean linear speed, m/s [1.68, or 0.42 of --max-speed]"));
  of("6d linear around", c->add_option("--min-speed", a->low, "m/s [1.0, or a quarter of --max-speed]"));
  of("6d linear around", c->add_option("--max-speed", a->high, "m/s [4.0]"));
  of("6d rotation", c->add_option("--angular", a->angular_mean,
                                  "mean angular speed, rad/s [0.95, or 0.43 of --max-angular]"));
  of("6d rotation", c->add_option("--max-angular", a->angular_high, "rad/s [2.2]"));
  of("6d rotation around",
     c->add_option("--ramp", a->options.ramp, "seconds from rest to --min-speed")->capture_default_str());
  of("6d", c->add_option("--loops", a->options.loops,
                         "6d: fly this many laps of one closed tour through all rooms"));
  c->add_option("--replay", a->options.replay_file, "recorded TUM trajectory to fly")->group("Motion");
  of("replay", c->add_option("--replay-speed", a->options.replay_speed, "times faster than recorded")
                   ->capture_default_str());

  const std::string camera = "Camera";
  c->add_option("--sensor", a->sensor,
                "kinect1: true depth with noise; kinect2, azure, l515 (time of flight), d400 (stereo), f200 "
                "(structured "
                "light), iphone (LiDAR): simulated by their physics, with their images, range and rate")
      ->capture_default_str()
      ->group(camera);
  c->add_option("--registered", a->registered,
                "carry depth onto the colour image: points (a larger image has holes), areas (as "
                "librealsense does), or "
                "none [f200: points, d400: areas, others: none]")
      ->expected(0, 1)
      ->default_str("points")
      ->group(camera);
  const auto free = [&](CLI::Option* option) {
    a->of_free_camera.push_back(option->group(camera));
    return option;
  };
  free(c->add_option("--width", a->options.intrinsics.width, "pixels")->capture_default_str());
  free(c->add_option("--height", a->options.intrinsics.height, "pixels")->capture_default_str());
  free(c->add_option("--fx", a->options.intrinsics.fx, "pixels")->capture_default_str());
  free(c->add_option("--fy", a->options.intrinsics.fy, "pixels")->capture_default_str());
  free(c->add_option("--cx", a->cx, "pixels [image centre]"));
  free(c->add_option("--cy", a->cy, "pixels [image centre]"));
  free(c->add_option("--max-depth", a->options.max_depth, "metres; what is further reads 0")
           ->capture_default_str());
  free(c->add_option(
           "--noise", a->noise,
           "depth noise: handa (Handa et al. 2014, unbiased), simkinect (rounded as that program does, "
           "which reads too near: 6 mm at 2 m), or none"))
      ->check(CLI::IsMember({"handa", "simkinect", "none"}))
      ->capture_default_str();
  a->options.colour = true;  // as depth cameras have it
  c->add_flag("--colour,--color,!--no-colour,!--no-color", a->options.colour,
              "write rgb/ as well [yes]; --no-colour: depth alone")
      ->group(camera);

  c->footer(
      "Examples:\n"
      "  rosefusion synth out/fast                           8 s, 1.7 m/s on average and up to 4 m/s\n"
      "  rosefusion synth out/faster --seed 7 --max-speed 6 --max-angular 4\n"
      "  rosefusion synth out/line --motion linear --noise none\n"
      "  rosefusion synth out/house --mesh house.ply --frames 10000 --loops 8\n"
      "  rosefusion synth out/desk3x --replay groundtruth.txt --replay-speed 3\n"
      "  rosefusion synth out/desk --scene desk --sensor d400\n"
      "  rosefusion synth out/thing --scene object --cut-out --sensor f200\n"
      "Exit codes: 0 finished, 2 bad input, 130 interrupted (nothing of the sequence is kept).");
  c->callback([a] { run(*a); });
}

}  // namespace rosefusion::cli
