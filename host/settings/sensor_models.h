// What depth cameras are known to err by, by name.
#pragma once
#include <span>
#include <string_view>

namespace rosefusion {

/// Of depth.sensor.
enum class DepthSensor {
  Given,  ///< depth.noise_floor, noise_growth and bias_growth, and refine.model_noise, are as they are set
  Auto,   ///< that of the list below whose noise the first images show
  Kinect1,
  Kinect2,
  Azure,
  D400,
  L515,
  F200,
  Iphone,
};

/// Lengths in metres, of a depth z in metres.
struct SensorModel {
  DepthSensor sensor;
  const char* name;  ///< as depth.sensor has it
  /// Depths of one pixel: noise_floor + noise_growth (z - 0.4)^2, what calibration leaves included; and
  /// bias_growth z^2 that the depths of a surface share.
  double noise_floor, noise_growth, bias_growth;
  /// What flat pieces of a twentieth of the image's width deviate from their planes by (standard deviation):
  /// flat_floor + flat_growth z^2.
  double flat_floor, flat_growth;
  double reach;  ///< no depths from beyond

  double flatDeviation(double z) const { return flat_floor + flat_growth * z * z; }
};

/// All that are known (tests/bench/notes/sensors.md#sensor-models).
std::span<const SensorModel> sensorModels();
/// Null for kGiven and kAuto, and for a name that none has.
const SensorModel* sensorModel(DepthSensor sensor);
const SensorModel* sensorModel(std::string_view name);

}  // namespace rosefusion
