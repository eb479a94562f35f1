#include "host/synth/tum_writer.h"

#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/core/file_io.h"
#include "host/core/number_text.h"
#include "host/core/staged_folder.h"
#include "host/export/mesh_io.h"
#include "host/export/png.h"
#include "host/synth/noise.h"
#include "host/synth/parallel.h"

namespace rosefusion {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReport = "synth.json";  // says that a folder holds a generated sequence

std::string stampText(double timestamp) {
  return printed("%.6f", timestamp);
}

void writeIndex(const fs::path& folder, const std::string& kind, const Trajectory& truth) {
  std::string text = "# timestamp filename\n";
  for (const StampedPose& p : truth) {
    const std::string stamp = stampText(p.timestamp);
    text += stamp + " " + kind + "/" + stamp + ".png\n";
  }
  writeFileAtomically(folder / (kind + ".txt"), text);
}

const char* nameOf(Motion motion) {
  switch (motion) {
    case Motion::Linear:
      return "linear";
    case Motion::Rotation:
      return "rotation";
    case Motion::Replay:
      return "replay";
    case Motion::Around:
      return "around";
    case Motion::SixDof:
      break;
  }
  return "6d";
}

}  // namespace

void requireUsableOutput(const fs::path& folder, bool force) {
  StagedFolder::requireUsable(folder, force ? kReport : "", "give another folder, or --force to replace it");
}

std::string synthReport(const SynthPlan& plan) {
  const SynthOptions& o = plan.options();
  const MotionStatistics s = plan.statistics();
  nlohmann::ordered_json json;
  json["seed"] = o.seed;
  json["scene"] = !o.mesh_file.empty()           ? o.mesh_file.string()
                  : o.scene == SceneKind::Desk   ? "procedural desk"
                  : o.scene == SceneKind::Object ? "procedural object"
                                                 : "procedural room";
  if (o.cut_out) json["cut_out"] = true;
  if (const Eigen::Vector3d& origin = plan.scene().origin; !origin.isZero())
    json["origin_m"] = {origin.x(), origin.y(), origin.z()};
  json["motion"] = nameOf(o.motion);
  if (o.motion == Motion::Replay) {
    json["replay"] = o.replay_file.string();
    json["replay_speed"] = o.replay_speed;
  } else {
    json["asked"]["linear_mps"] = {{"min", o.linear.low}, {"mean", o.linear.mean}, {"max", o.linear.high}};
    json["asked"]["angular_radps"] = {{"mean", o.angular.mean}, {"max", o.angular.high}};
    json["loops"] = o.loops;
  }
  json["frames"] = plan.truth().size();
  json["fps"] = o.fps;
  json["camera"] = {{"width", o.intrinsics.width}, {"height", o.intrinsics.height}, {"fx", o.intrinsics.fx},
                    {"fy", o.intrinsics.fy},       {"cx", o.intrinsics.cx},         {"cy", o.intrinsics.cy}};
  json["depth_units_per_metre"] = kSynthDepthUnitsPerMetre;
  json["max_depth_m"] = o.max_depth;
  if (const Sensor& sensor = o.sensor; sensor.principle != DepthPrinciple::Noise) {
    json["sensor"] = sensor.name;
    json["registered"] = toString(sensor.registration);
  } else {
    json["noise"] = toString(o.noise);
  }
  // Earlier sequences called "handa" what "simkinect" is now.
  if (o.noise != DepthNoise::None)
    json["disparity"] = o.noise == DepthNoise::Handa ? "floor(d + n + 0.5)" : "round(d + n + 0.5)";
  json["colour"] = o.colour;
  // Earlier sequences had colours without noise.
  if (o.colour && (o.noise != DepthNoise::None || o.sensor.principle != DepthPrinciple::Noise))
    json["colour_sigma"] = kColourSigma;
  json["up"] = {plan.scene().up.x(), plan.scene().up.y(), plan.scene().up.z()};
  json["true_motion"] = {{"linear_mean_mps", s.linear_mean},
                         {"linear_max_mps", s.linear_max},
                         {"angular_mean_radps", s.angular_mean},
                         {"angular_max_radps", s.angular_max},
                         {"length_m", s.length},
                         {"least_clearance_m", s.clearance}};
  return json.dump(2) + "\n";
}

void writeTumSequence(const fs::path& out, const SynthPlan& plan, bool force,
                      const std::function<void(int, int)>& progress) {
  StagedFolder folder(out, force ? kReport : "");
  const fs::path& part = folder.part();
  const SynthOptions& options = plan.options();
  const int count = static_cast<int>(plan.truth().size());
  std::vector<std::uint8_t> seen(plan.scene().mesh.triangles.size(), 0);
  std::mutex progress_mutex;
  int done = 0;
  parallelFor(count, options.threads, [&](int i) {
    const Frame frame = plan.renderFrame(i, &seen);
    const std::string name = stampText(frame.timestamp) + ".png";
    writePng(part / "depth" / name, frame.depth);
    if (options.colour) writePng(part / "rgb" / name, frame.colour);
    const std::lock_guard lock(progress_mutex);
    ++done;
    if (progress) progress(done, count);
  });
  writeIndex(part, "depth", plan.truth());
  if (options.colour) writeIndex(part, "rgb", plan.truth());
  writeTumTrajectory(part / "groundtruth.txt", plan.truth());
  const Intrinsics& k = options.intrinsics;
  writeFileAtomically(part / "calibration.txt", printed("%.9g %.9g %.9g %.9g\n", k.fx, k.fy, k.cx, k.cy));
  writePly(part / "mesh.ply", plan.scene().mesh);
  writePly(part / "mesh_seen.ply", seenPart(plan.scene().mesh, seen));
  writeFileAtomically(part / kReport, synthReport(plan));
  folder.takePlace();
}

}  // namespace rosefusion
