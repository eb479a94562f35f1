// What is measured on images of slanted planes with known noise, and what follows from it.
#include "host/survey/scene_survey.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace rosefusion::testing {
namespace test_scene_survey {

using ::testing::HasSubstr;

constexpr double kUnits = 9000;  // fine enough not to round the noise away
const Intrinsics kCamera{640, 480, 500, 500, 319.5, 239.5};

/// A floor seen from `height` above it, whose depths grow towards the image's top, with normal noise.
cv::Mat floorFrom(double height, double (*deviation)(double)) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  cv::Mat depth(kCamera.height, kCamera.width, CV_16UC1);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const double z = height / (0.3 + 0.7 * v / depth.rows);
      depth.at<std::uint16_t>(v, u) =
          static_cast<std::uint16_t>(kUnits * (z + deviation(z) * normal(random)));
    }
  return depth;
}

double kinect(double z) {
  return 0.0004 + 0.0012 * z * z;
}
double stereo(double z) {
  return 0.0005 + 0.0032 * z * z;
}
double nothing(double) {
  return 0;
}

std::optional<SceneMeasures> survey(const cv::Mat& depth, const Intrinsics& camera = kCamera) {
  return surveyScene(std::vector<cv::Mat>{depth}, camera, kUnits, DepthSettings{});
}
Settings automatic() {
  Settings settings;
  for (const char* each : {"volume.voxel_size=auto", "volume.truncation=auto", "depth.sensor=auto"})
    applyAssignment(settings, each);
  return settings;
}

TEST(SceneSurvey, DepthsAndNoiseAreMeasured) {
  const auto scene = survey(floorFrom(1, stereo));
  ASSERT_TRUE(scene);
  EXPECT_NEAR(scene->median_depth, 1 / 0.65, 0.01);
  EXPECT_NEAR(scene->far_depth, 1 / 0.37, 0.05);
  ASSERT_GE(scene->flat.size(), 3u);
  for (const SceneMeasures::Deviation& at : scene->flat)
    EXPECT_NEAR(at.deviation / stereo(at.depth), 1, 0.15) << at.depth;
}

TEST(SceneSurvey, TheSensorIsKnownByItsNoise) {
  EXPECT_EQ(resolved(automatic(), survey(floorFrom(1, kinect))).depth.sensor, DepthSensor::Kinect1);
  EXPECT_EQ(resolved(automatic(), survey(floorFrom(1, stereo))).depth.sensor, DepthSensor::D400);
  const Settings stereo_settings = resolved(automatic(), survey(floorFrom(1, stereo)));
  EXPECT_EQ(stereo_settings.depth.noise_growth, sensorModel(DepthSensor::D400)->noise_growth);
  EXPECT_EQ(stereo_settings.refine.model_noise, 2 * stereo_settings.depth.noise_floor);
}

double nearArm(double z) {
  return 0.0009 + 0.0008 * z * z;
}

TEST(SceneSurvey, ASensorThatReachesNoFartherIsNotTaken) {
  EXPECT_EQ(resolved(automatic(), survey(floorFrom(0.25, nearArm))).depth.sensor, DepthSensor::F200);
  EXPECT_NE(resolved(automatic(), survey(floorFrom(1, nearArm))).depth.sensor, DepthSensor::F200);
}

TEST(SceneSurvey, NoiseOfNoSensorLeavesWhatIsSet) {
  Settings asked = automatic();
  const auto scene = survey(floorFrom(1, nothing));
  const Settings taken = resolved(asked, scene);
  EXPECT_EQ(taken.depth.noise_floor, asked.depth.noise_floor);
  EXPECT_THAT(choicesOf(asked, taken, scene).back(), HasSubstr("no sensor known"));
}

TEST(SceneSurvey, ASensorThatTheDepthContradictsIsTold) {
  Settings asked = automatic();
  applyAssignment(asked, "depth.sensor=d400");
  const auto scene = survey(floorFrom(1, nothing));
  EXPECT_THAT(choicesOf(asked, resolved(asked, scene), scene).back(), HasSubstr("unlike a d400's"));
}

// A time-of-flight camera's millimetre would call most of a stereo camera's pixels edges.
TEST(SceneSurvey, MeasuredNoiseOutweighsTheNamedSensor) {
  Settings asked = automatic();
  applyAssignment(asked, "depth.sensor=kinect2");
  const auto noisy = survey(floorFrom(1, stereo)), smooth = survey(floorFrom(1, nothing));
  const Settings taken = resolved(asked, noisy);
  EXPECT_EQ(taken.depth.sensor, DepthSensor::D400);
  EXPECT_EQ(taken.depth.noise_growth, sensorModel(DepthSensor::D400)->noise_growth);
  EXPECT_THAT(choicesOf(asked, taken, noisy).back(),
              AllOf(HasSubstr("noisier than a kinect2's"), HasSubstr("taken as a d400's")));
  EXPECT_EQ(resolved(asked, smooth).depth.sensor, DepthSensor::Kinect2) << "less noise does no harm";
}

TEST(SceneSurvey, TheRecordingsSensorIsTakenToo) {
  auto smooth = survey(floorFrom(1, kinect)), noisy = survey(floorFrom(1, stereo));
  smooth->sensor = noisy->sensor = "azure";
  EXPECT_EQ(resolved(automatic(), smooth).depth.sensor, DepthSensor::Azure) << "the noise is a kinect1's";
  EXPECT_THAT(choicesOf(automatic(), resolved(automatic(), smooth), smooth).back(),
              HasSubstr("of a sensor azure"));
  EXPECT_EQ(resolved(automatic(), noisy).depth.sensor, DepthSensor::D400) << "far noisier";
  Settings asked = automatic();
  applyAssignment(asked, "depth.sensor=kinect2");
  EXPECT_EQ(resolved(asked, smooth).depth.sensor, DepthSensor::Kinect2) << "the user knows better";
  smooth->sensor = "another";
  EXPECT_EQ(resolved(automatic(), smooth).depth.sensor, DepthSensor::Kinect1);
}

TEST(SceneSurvey, VoxelsFollowTheSizeOfTheView) {
  const auto voxel = [](double height) {
    return resolved(automatic(), survey(floorFrom(height, kinect))).volume;
  };
  EXPECT_EQ(voxel(0.25).voxel_size, 0.005);
  EXPECT_EQ(voxel(0.25).truncation, 0.02);
  EXPECT_EQ(voxel(1).voxel_size, 0.02);
  EXPECT_EQ(voxel(1.5).voxel_size, 0.02);
  EXPECT_EQ(voxel(1.5).truncation, 0.06);
}

TEST(SceneSurvey, NoVoxelIsFinerThanTheNoiseMeasured) {
  const auto rough = [](double) { return 0.015; };
  cv::Mat depth = floorFrom(0.5, rough);
  depth.colRange(0, 240).setTo(0);
  depth.colRange(400, 640).setTo(0);
  EXPECT_GE(resolved(automatic(), survey(depth)).volume.voxel_size, 0.01) << "by the sensor alone 0.005";
}

TEST(SceneSurvey, NoisyDepthsAreTruncatedFartherOff) {
  const VolumeSettings noisy = resolved(automatic(), survey(floorFrom(1.5, stereo))).volume;
  EXPECT_EQ(noisy.voxel_size, 0.02);
  EXPECT_GE(noisy.truncation, 0.1);
}

TEST(SceneSurvey, AThingCutOutIsAsSmallAsItIs) {
  cv::Mat depth = floorFrom(0.5, kinect);
  depth.colRange(0, 220).setTo(0);
  depth.colRange(420, 640).setTo(0);
  EXPECT_EQ(resolved(automatic(), survey(depth)).volume.voxel_size, 0.005);
  EXPECT_EQ(resolved(automatic(), survey(floorFrom(0.5, kinect))).volume.voxel_size, 0.01);
}

// A Kinect's floor of 5 mm is what a surface's depths are off together, and blurs none of it.
TEST(SceneSurvey, ASmallThingGetsTheFinestVoxels) {
  cv::Mat depth = floorFrom(0.4, kinect);
  depth.colRange(0, 270).setTo(0);
  depth.colRange(370, 640).setTo(0);
  const Settings taken = resolved(automatic(), survey(depth));
  EXPECT_EQ(taken.depth.sensor, DepthSensor::Kinect1);
  EXPECT_EQ(taken.volume.voxel_size, 0.0025);
  EXPECT_EQ(taken.volume.truncation, 0.01);
}

TEST(SceneSurvey, ImagesThatShowLittleAreTakenFromLittleOn) {
  cv::Mat depth = cv::Mat::zeros(kCamera.height, kCamera.width, CV_16UC1);
  const cv::Rect thing(290, 200, 60, 80);  // 1.6 % of the pixels
  floorFrom(0.5, kinect)(thing).copyTo(depth(thing));
  const auto scene = survey(depth);
  ASSERT_TRUE(scene);
  const Settings taken = resolved(automatic(), scene);
  EXPECT_NEAR(taken.tracking.min_valid_share, 0.25 * thing.area() / depth.total(), 1e-4);
  EXPECT_LE(taken.volume.voxel_size, 0.005);
  EXPECT_THAT(choicesOf(automatic(), taken, scene),
              ::testing::Contains(HasSubstr("tracking.min_valid_share")));
  const Settings whole = resolved(automatic(), survey(floorFrom(0.5, kinect)));
  EXPECT_EQ(whole.tracking.min_valid_share, automatic().tracking.min_valid_share);
}

TEST(SceneSurvey, APhonesImagesSetNoiseAndVoxels) {
  const Intrinsics phone{256, 192, 212, 212, 127.5, 95.5};
  cv::Mat depth(phone.height, phone.width, CV_16UC1, cv::Scalar(0.6 * kUnits));
  const Settings taken = resolved(automatic(), survey(depth, phone));
  EXPECT_EQ(taken.depth.sensor, DepthSensor::Iphone);
  EXPECT_GE(taken.volume.voxel_size, 0.8 * 0.6 / phone.fx) << "the nearest step";
}

TEST(SceneSurvey, WhatIsGivenStays) {
  Settings asked = automatic();
  applyAssignment(asked, "volume.voxel_size=0.013");
  applyAssignment(asked, "depth.noise_floor=0.0077");
  const Settings taken = resolved(asked, survey(floorFrom(0.3, stereo)));
  EXPECT_EQ(taken.volume.voxel_size, 0.013);
  EXPECT_EQ(taken.depth.noise_floor, 0.0077) << "a noise set by hand outweighs 'auto'";
  EXPECT_EQ(taken.depth.sensor, DepthSensor::Given);
}

TEST(SceneSurvey, NothingInViewIsNoScene) {
  EXPECT_FALSE(survey(cv::Mat::zeros(kCamera.height, kCamera.width, CV_16UC1)));
  EXPECT_EQ(resolved(automatic()).volume.voxel_size, 0.02);
  EXPECT_EQ(resolved(automatic()).volume.truncation, 0.06);
  EXPECT_THAT(choicesOf(automatic(), resolved(automatic()), {}).at(0), HasSubstr("too little depth"));
}

TEST(SceneSurvey, AutoIsWrittenAndReadAgain) {
  Settings read;
  applyYamlText(read, toYaml(automatic()), "test");
  EXPECT_EQ(fieldText(read, "volume.voxel_size", ""), "auto");
  EXPECT_EQ(fieldText(read, "depth.sensor", ""), "auto");
}

}  // namespace test_scene_survey
}  // namespace rosefusion::testing
