#include "host/bench/sensor_suite.h"

#include <algorithm>
#include <numbers>

#include "host/bench/generated_sequence.h"
#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/log_to_spdlog.h"
#include "host/core/number_text.h"
#include "host/run/scene_of_source.h"
#include "host/settings/automatic.h"
#include "host/sources/sequence_source.h"

namespace rosefusion {
namespace {

namespace fs = std::filesystem;

constexpr int kFramesOfTurn = 145;  // one turn at 2.5 degrees a frame, and its first view once more

struct SensorFlight {
  std::string name;
  SynthOptions synth;
};

SceneKind sceneNamed(const std::string& word) {
  for (const auto& [name, kind] :
       {std::pair{"room", SceneKind::Room}, {"desk", SceneKind::Desk}, {"object", SceneKind::Object}})
    if (word == name) return kind;
  throw InputError("--scene: there is no scene '" + word + "'; give room, desk or object.");
}

/// `max_speed` 0: a full turn around an object.
SensorFlight flightOf(const SensorSuiteOptions& options, const Sensor& sensor, const std::string& scene,
                      double max_speed) {
  SensorFlight flight{sensor.name + "_" + scene + "_" + (max_speed > 0 ? printed("%g", max_speed) : "turn"),
                      {}};
  SynthOptions& synth = flight.synth;
  synth.seed = options.seed;
  synth.scene = sceneNamed(scene);
  synth.colour = options.settings.volume.colour;
  synth.frames = options.frames;
  synth.sensor = sensor;
  if (sensor.principle != DepthPrinciple::Noise) {
    synth.intrinsics = sensor.output();
    synth.fps = sensor.fps;
  }
  if (synth.scene != SceneKind::Room) {
    synth.motion = Motion::Around;
    synth.linear = {0.15, 0.5, 0.9};  // by hand
  }
  synth.cut_out = synth.scene == SceneKind::Object;
  if (max_speed > 0) {
    synth.linear = synth.linear.endingAt(max_speed);
    synth.turn_per_frame = 0;
  } else {
    synth.frames = kFramesOfTurn;
  }
  requirePlausible(synth);
  return flight;
}

std::vector<SensorFlight> flightsOf(const SensorSuiteOptions& options) {
  std::vector<std::string> names = options.sensors, scenes = options.scenes;
  if (names.empty())
    for (const Sensor& sensor : sensors()) names.push_back(sensor.name);
  if (scenes.empty()) scenes = {"room", "desk", "object"};
  std::vector<SensorFlight> flights;
  for (const std::string& scene : scenes) {
    std::vector<double> speeds = scene == "room" ? std::vector{1.0, 2.0, 4.0} : std::vector{0.3, 0.6, 1.2};
    if (options.max_speed) speeds = {*options.max_speed};
    if (scene == "object" && !options.max_speed) speeds.push_back(0);
    for (const std::string& name : names)
      for (const double speed : speeds) flights.push_back(flightOf(options, sensorNamed(name), scene, speed));
  }
  return flights;
}

double medianDepth(Sequence& sequence) {
  constexpr std::size_t kEvery = 10;
  std::vector<std::uint16_t> depths;
  Frame frame;
  std::string problem;
  for (std::size_t i = 0; i < sequence.size(); i += kEvery)
    if (sequence.read(i, frame, problem))
      std::copy_if(frame.depth.begin<std::uint16_t>(), frame.depth.end<std::uint16_t>(),
                   std::back_inserter(depths), [](std::uint16_t depth) { return depth > 0; });
  if (depths.empty()) return 0;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle / sequence.info().depth_units_per_metre;
}

double turnError(const RunSummary& summary, const SequenceInfo& info) {
  const std::optional<TrajectoryErrors> errors = errorsOf(summary, info);
  if (!errors || errors->per_frame.empty()) return 0;
  const PosePair &first = errors->per_frame.front().poses, &last = errors->per_frame.back().poses;
  return rotationAngle((first.truth.inverse() * last.truth).inverse() *
                       (first.estimate.inverse() * last.estimate));
}

/// Nothing when interrupted.
std::optional<SensorRow> track(Device& device, const SensorSuiteOptions& options, const SensorFlight& flight,
                               const std::function<bool()>& stop) {
  std::optional<ScratchFolder> scratch;
  if (options.work.empty()) scratch.emplace("bench");
  const fs::path folder =
      (scratch ? scratch->path() : options.work) / (flight.name + "_" + std::to_string(options.seed));
  const std::unique_ptr<Sequence> sequence = generatedSequence(folder, flight.synth);
  SensorRow row;
  row.median_depth = medianDepth(*sequence);
  PeekedSource source(std::make_unique<SequenceSource>(*sequence, RunOptions{}));
  row.taken = resolved(options.settings, sceneOf(source, options.settings, {}));
  const SequenceInfo& info = sequence->info();
  Pipeline pipeline(device, row.taken, info.intrinsics, info.depth_units_per_metre, logToSpdlog);
  const RunSummary summary = reconstruct(source, pipeline, 0, {}, stop);
  if (summary.end == RunEnd::Interrupted) return {};
  row.tracked = judge(flight.name, summary, info, source.expectedFrames(), pipeline);
  row.turn_error = turnError(summary, info);
  return row;
}

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

std::string sensorOf(const Settings& settings) {
  const SensorModel* model = sensorModel(settings.depth.sensor);
  return model ? model->name : "none";
}

std::size_t goodRows(const SensorReport& r) {
  return static_cast<std::size_t>(
      std::count_if(r.rows.begin(), r.rows.end(), [](const SensorRow& row) { return row.good(); }));
}

}  // namespace

bool SensorRow::good() const {
  return tracked.frames > 0 && 100 * tracked.lost <= tracked.frames && share() <= 0.005 &&
         degrees(turn_error) <= 1;
}

SensorReport trackSensors(Device& device, const SensorSuiteOptions& options,
                          const std::function<void(const SensorRow&)>& done,
                          const std::function<bool()>& stop) {
  SensorReport report{device.info(), options, {}, false};
  for (const SensorFlight& flight : flightsOf(options)) {
    std::optional<SensorRow> row = track(device, options, flight, stop);
    report.interrupted = !row;
    if (!row) break;
    report.rows.push_back(std::move(*row));
    if (done) done(report.rows.back());
  }
  return report;
}

nlohmann::ordered_json sensorJson(const SensorReport& r) {
  using Json = nlohmann::ordered_json;
  Json json = {
      {"suite", "sensors"},
      {"device", {{"name", r.device.name}, {"driver", r.device.driver}, {"type", toString(r.device.type)}}},
      {"settings", r.options.settings_name},
      {"seed", r.options.seed},
      {"frames", r.options.frames},
      {"interrupted", r.interrupted},
      {"sequences", Json::array()}};
  for (const SensorRow& row : r.rows)
    json["sequences"].push_back({{"name", row.tracked.name},
                                 {"good", row.good()},
                                 {"judged_frames", row.tracked.frames},
                                 {"uncertain", row.tracked.uncertain},
                                 {"lost", row.tracked.lost},
                                 {"ate_rmse_m", row.tracked.ate_m.rmse},
                                 {"ate_max_m", row.tracked.ate_m.max},
                                 {"median_depth_m", row.median_depth},
                                 {"ate_share_of_depth", row.share()},
                                 {"turn_error_rad", row.turn_error},
                                 {"voxel_size_m", row.taken.volume.voxel_size},
                                 {"truncation_m", row.taken.volume.truncation},
                                 {"sensor", sensorOf(row.taken)},
                                 {"ms_per_frame", row.tracked.ms_per_frame}});
  json["summary"] = {{"sequences", r.rows.size()}, {"good", goodRows(r)}};
  return json;
}

std::string sensorHead(const DeviceInfo& device) {
  return device.name + ", " + device.driver + "\n" +
         printed("%-22s %7s %9s %6s %8s %8s %8s %8s  %s\n", "sequence", "frames", "uncertain", "lost",
                 "ATE cm", "depth m", "ATE %", "turn deg", "chosen");
}

std::string sensorRow(const SensorRow& row) {
  const TrackedSequence& t = row.tracked;
  return printed("%-22.22s %7zu %9zu %6zu %8.2f %8.2f %8.2f %8.2f  %g cm, %s%s\n", t.name.c_str(), t.frames,
                 t.uncertain, t.lost, 100 * t.ate_m.rmse, row.median_depth, 100 * row.share(),
                 degrees(row.turn_error), 100 * row.taken.volume.voxel_size, sensorOf(row.taken).c_str(),
                 row.good() ? "" : "  FAILED");
}

std::string sensorSummary(const SensorReport& r) {
  return printed(
      "%zu of %zu sequences with at most 1 %% of the frames lost, an ATE of at most 0.5 %% of the median "
      "depth "
      "and, from the first to the last pose, a turn within 1 degree of the true one.\n",
      goodRows(r), r.rows.size());
}

}  // namespace rosefusion
