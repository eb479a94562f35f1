// Tracking with every depth camera that can be simulated, in rooms, at desks and around objects, at several
// speeds: as `rosefusion run` would, with what it chooses by itself.
#pragma once
#include "host/bench/tracking_suite.h"

namespace rosefusion {

struct SensorSuiteOptions {
  Settings settings;                 ///< 'auto' where it is to be chosen for each sequence
  std::string settings_name;         ///< preset and changes, for the report
  std::uint64_t seed = 1;            ///< of every scene, motion and noise
  int frames = 90;                   ///< of every sequence but the full turns around an object
  std::vector<std::string> sensors;  ///< by sensorNamed(); empty: all
  std::vector<std::string> scenes;   ///< room, desk, object; empty: all
  std::optional<double> max_speed;   ///< m/s; without: 1, 2 and 4 in rooms, 0.3, 0.6 and 1.2 else, and turns
  std::filesystem::path work;        ///< keeps the generated sequences; empty: a temporary folder
};

/// One row of the table.
struct SensorRow {
  TrackedSequence tracked;
  double median_depth = 0;  ///< metres
  double turn_error = 0;    ///< radians, from the first pose to the last
  Settings taken;           ///< as they were chosen
  double share() const { return median_depth > 0 ? tracked.ate_m.rmse / median_depth : 0; }
  /// At most a hundredth lost, an ATE of at most half a hundredth of the depth, and a turn closed within a
  /// degree.
  bool good() const;
};

struct SensorReport {
  DeviceInfo device;
  SensorSuiteOptions options;
  std::vector<SensorRow> rows;
  bool interrupted = false;
};

/// As trackSuite().
SensorReport trackSensors(Device& device, const SensorSuiteOptions& options,
                          const std::function<void(const SensorRow&)>& done = {},
                          const std::function<bool()>& stop = {});

nlohmann::ordered_json sensorJson(const SensorReport& report);
/// As those of the tracking suite.
std::string sensorHead(const DeviceInfo& device);
std::string sensorRow(const SensorRow& row);
std::string sensorSummary(const SensorReport& report);

}  // namespace rosefusion
