// The suite of simulated cameras, on one small camera and few frames.
#include <gmock/gmock.h>

#include "host/bench/sensor_suite.h"
#include "host/core/error.h"
#include "host/settings/settings.h"
#include "tests/engine/validating_device.h"
#include "tests/host/slam/short_sequence.h"

namespace rosefusion::testing {
namespace test_sensor_suite {

using ::testing::HasSubstr;

class SensorSuite : public ValidatingDevice {
 protected:
  SensorSuite() {
    options_.settings = quickSettings();
    options_.settings.volume.colour = false;
    options_.settings.volume.voxel_size = options_.settings.volume.truncation = 0;
    options_.settings.depth.sensor = DepthSensor::Auto;
    options_.sensors = {"iphone"};
    options_.scenes = {"object"};
    options_.max_speed = 0.5;
    options_.frames = 6;
  }
  SensorSuiteOptions options_;
};

TEST_F(SensorSuite, TracksWithWhatIsChosenForEachSequence) {
  const SensorReport report = trackSensors(device(), options_);
  ASSERT_EQ(report.rows.size(), 1u);
  const SensorRow& row = report.rows.front();
  EXPECT_EQ(row.tracked.name, "iphone_object_0.5");
  EXPECT_EQ(row.tracked.frames, 6u);
  EXPECT_EQ(row.taken.depth.sensor, DepthSensor::Iphone);
  EXPECT_GT(row.taken.volume.voxel_size, 0);
  EXPECT_LT(row.taken.volume.voxel_size, 0.02) << "an object is small";
  EXPECT_GT(row.median_depth, 0.3);
  EXPECT_LT(row.median_depth, 1.2);
  EXPECT_GT(row.turn_error, 0);
  EXPECT_THAT(sensorRow(row), HasSubstr("iphone_object_0.5"));
  const nlohmann::ordered_json json = sensorJson(report);
  for (const char* key : {"lost", "ate_rmse_m", "ate_share_of_depth", "turn_error_rad", "voxel_size_m"})
    EXPECT_TRUE(json.at("sequences")[0].at(key).is_number()) << key;
}

TEST_F(SensorSuite, RefusesWhatItCannotSimulate) {
  options_.sensors = {"sonar"};
  EXPECT_THROW(trackSensors(device(), options_), InputError);
  options_.sensors = {"d400"};
  options_.scenes = {"moon"};
  EXPECT_THROW(trackSensors(device(), options_), InputError);
}

}  // namespace test_sensor_suite
}  // namespace rosefusion::testing
