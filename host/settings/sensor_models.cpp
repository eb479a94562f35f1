#include "host/settings/sensor_models.h"

#include <algorithm>
#include <iterator>

namespace rosefusion {
namespace {

// Kinect v1: Nguyen, Izadi and Lovell 2012, and what recordings drift by. D400: a disparity of stereo errs
// alike everywhere, so depths by z^2; F200: structured light at arm's length. Both as measured on recordings.
// Time of flight (Kinect v2, Azure, L515) hardly grows with depth, and is off by millimetres that no average
// takes out. A phone's depths are interpolated from some hundred: smooth, and off together.
constexpr SensorModel kModels[] = {
    {DepthSensor::Kinect1, "kinect1", 0.005, 0.0019, 0.003, 0.0004, 0.0012, 12},
    {DepthSensor::Kinect2, "kinect2", 0.004, 0.0006, 0.002, 0.0012, 0.0003, 10},
    {DepthSensor::Azure, "azure", 0.004, 0.0005, 0.002, 0.0011, 0.0002, 8},
    {DepthSensor::D400, "d400", 0.003, 0.0060, 0.003, 0.0005, 0.0032, 30},
    {DepthSensor::L515, "l515", 0.003, 0.0005, 0.001, 0.0015, 0.0003, 10},
    {DepthSensor::F200, "f200", 0.002, 0.0020, 0.003, 0.0009, 0.0008, 1.6},
    {DepthSensor::Iphone, "iphone", 0.008, 0.0015, 0.004, 0.0015, 0.0005, 6},
};

}  // namespace

std::span<const SensorModel> sensorModels() {
  return kModels;
}

const SensorModel* sensorModel(DepthSensor sensor) {
  const auto found = std::find_if(std::begin(kModels), std::end(kModels),
                                  [&](const SensorModel& model) { return model.sensor == sensor; });
  return found == std::end(kModels) ? nullptr : &*found;
}

const SensorModel* sensorModel(std::string_view name) {
  const auto found = std::find_if(std::begin(kModels), std::end(kModels),
                                  [&](const SensorModel& model) { return model.name == name; });
  return found == std::end(kModels) ? nullptr : &*found;
}

}  // namespace rosefusion
