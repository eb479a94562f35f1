// What tells one simulated camera from another, on scenes of a few walls.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "host/core/error.h"
#include "host/synth/depth_simulation.h"
#include "host/synth/noise.h"
#include "host/synth/renderer.h"
#include "host/synth/sequence.h"
#include "host/synth/shapes.h"
#include "tests/host/synth/small_options.h"

namespace rosefusion::testing {
namespace test_sensors {

/// A wall at z = `far` across the view (the camera looks along +z from the origin) and, with `near`, a panel
/// before it of 0.3 m x 0.4 m.
Scene wallScene(double far, double near = 0) {
  Scene scene;
  const ShapeBuilder shapes(scene, Eigen::Isometry3d::Identity());
  const auto white = shapes.addMaterial({{220, 220, 220}, Pattern::Noise, 0.1f});
  shapes.quad({-8, -8, far}, {0, 16, 0}, {16, 0, 0}, white);
  if (near > 0) shapes.quad({-0.15, -0.2, near}, {0, 0.4, 0}, {0.3, 0, 0}, white);
  paintVertices(scene);
  return scene;
}

/// Depth of a camera at the origin that moves along x.
cv::Mat depthOf(const Sensor& sensor, const Scene& scene, std::uint64_t seed = 1, double speed = 0) {
  const Tracer tracer(scene);
  Rng rng(seed);
  return simulateDepth(
      sensor, tracer, [&](double t) -> Pose { return Pose(Eigen::Translation3d(speed * t, 0, 0)); }, rng);
}

Sensor unregistered(const char* name) {
  Sensor sensor = sensorNamed(name);
  sensor.registration = Registration::None;
  return sensor;
}

double validShare(const cv::Mat& depth, const cv::Rect& part) {
  return double(cv::countNonZero(depth(part) > 0)) / part.area();
}

/// Root mean square of (value - truth) over the valid pixels of a part, without the farthest 2 %.
double spread(const cv::Mat& depth, const cv::Rect& part, double truth) {
  std::vector<double> squares;
  for (int v = part.y; v < part.y + part.height; ++v)
    for (int u = part.x; u < part.x + part.width; ++u)
      if (const double z = depth.at<float>(v, u); z > 0) squares.push_back((z - truth) * (z - truth));
  std::sort(squares.begin(), squares.end());
  squares.resize(squares.size() * 98 / 100);
  double sum = 0;
  for (const double s : squares) sum += s;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

TEST(Sensors, AreKnownByName) {
  for (const Sensor& s : sensors()) EXPECT_EQ(sensorNamed(s.name).depth, s.depth);
  try {
    sensorNamed("kinect3");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::AllOf(::testing::HasSubstr("kinect3"), ::testing::HasSubstr("d400"),
                                               ::testing::HasSubstr("iphone")));
  }
}

TEST(Sensors, StereoHasItsShadowLeftOfAnEdgeOnly) {
  const Sensor d400 = unregistered("d400");
  const cv::Mat depth = depthOf(d400, wallScene(1.2, 0.6));
  // The panel spans columns 223 to 416; the wall's pixels that only the left view sees are 385 * 0.05 *
  // (1/0.6 - 1/1.2) = 16 wide.
  EXPECT_LT(validShare(depth, {211, 200, 8, 80}), 0.3);
  EXPECT_GT(validShare(depth, {425, 200, 16, 80}), 0.8);
  EXPECT_GT(validShare(depth, {240, 200, 160, 80}), 0.95);
}

TEST(Sensors, StereoErrsWithTheSquareOfTheDepth) {
  const Sensor d400 = unregistered("d400");
  const cv::Rect middle(160, 120, 320, 240);
  const double at_1 = spread(depthOf(d400, wallScene(1)), middle, 1),
               at_3 = spread(depthOf(d400, wallScene(3)), middle, 3);
  EXPECT_GT(at_1, 0.0005);
  EXPECT_LT(at_1, 0.006);
  EXPECT_GT(at_3 / at_1, 4);
  EXPECT_LT(at_3 / at_1, 20);
}

TEST(Sensors, StructuredLightHasTheProjectorsShadow) {
  const Sensor f200 = unregistered("f200");
  const cv::Mat depth = depthOf(f200, wallScene(0.8, 0.4));
  // The panel spans columns 141 to 498, its shadow 475 * 0.047 * (1/0.4 - 1/0.8) = 28 columns on its left.
  EXPECT_LT(validShare(depth, {116, 180, 20, 120}), 0.05);
  EXPECT_GT(validShare(depth, {505, 180, 28, 120}), 0.95);
}

TEST(Sensors, StructuredLightEndsWhereItIsTooWeak) {
  const Sensor f200 = unregistered("f200");
  EXPECT_GT(validShare(depthOf(f200, wallScene(1)), {160, 120, 320, 240}), 0.95);
  EXPECT_LT(validShare(depthOf(f200, wallScene(1.85)), {160, 120, 320, 240}), 0.1);
}

TEST(Sensors, SparsePointsLeaveOnePixelHoles) {
  Sensor f200 = sensorNamed("f200");
  const Scene wall = wallScene(0.7);
  const cv::Rect middle(160, 120, 320, 240);
  const double scale = f200.depth.fx / f200.colour.fx;
  const cv::Mat points = depthOf(f200, wall);
  EXPECT_NEAR(validShare(points, middle), scale * scale, 0.03);
  f200.registration = Registration::Areas;
  EXPECT_GT(validShare(depthOf(f200, wall), middle), 0.99);
  // Hardly a gap along a row that has depth is wider than a pixel.
  int wide = 0;
  for (int v = middle.y; v < middle.y + middle.height; ++v) {
    if (validShare(points, {middle.x, v, middle.width, 1}) < 0.5) continue;
    for (int u = middle.x; u < middle.x + middle.width; ++u)
      wide += points.at<float>(v, u) <= 0 && points.at<float>(v, u + 1) <= 0;
  }
  EXPECT_LT(wide, 100);
}

TEST(Sensors, RegisteredDepthIsSeenFromTheColourCamera) {
  const Intrinsics from{40, 30, 40, 40, 19.5, 14.5}, to{60, 40, 50, 50, 29.5, 19.5};
  cv::Mat depth(30, 40, CV_32FC1, cv::Scalar(0));
  depth.at<float>(10, 25) = 2;
  depth.at<float>(10, 26) = 1;
  const Pose moved(Eigen::Translation3d(0.1, 0, 0.5));
  const cv::Mat registered = registerDepth(depth, from, to, moved, Registration::Points);
  EXPECT_EQ(cv::countNonZero(registered), 2);
  const Eigen::Vector3d p = moved * from.unproject(25, 10, 2);
  const Eigen::Vector2d pixel = to.project(p);
  EXPECT_NEAR(registered.at<float>(int(std::lround(pixel.y())), int(std::lround(pixel.x()))), 2.5, 1e-5);
}

int flyingPixels(const cv::Mat& depth, double near, double far) {
  int flying = 0;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u)
      flying += depth.at<float>(v, u) > near + 0.05 && depth.at<float>(v, u) < far - 0.05;
  return flying;
}

TEST(Sensors, TimeOfFlightHasFlyingPixelsAtEdges) {
  // 0.35 m apart, within half a period, so that what lies between is not told from a surface.
  const Scene panel = wallScene(1.35, 1);
  const int flying = flyingPixels(depthOf(unregistered("kinect2"), panel), 1, 1.35);
  EXPECT_GT(flying, 20);    // the panel's edge is some 510 pixels long
  EXPECT_LT(flying, 1500);  // and nothing flies elsewhere
  EXPECT_EQ(flyingPixels(depthOf(unregistered("f200"), panel), 1, 1.35), 0);
}

TEST(Sensors, PhasesTakenInMotionSpoilEdges) {
  const Scene panel = wallScene(1.35, 1);
  const Sensor kinect2 = unregistered("kinect2");
  const auto spoilt = [&](double speed) {
    const cv::Mat depth = depthOf(kinect2, panel, 1, speed);
    int count = 0;
    for (int v = 150; v < 270; ++v)
      for (int u = 170; u < 340; ++u) {
        const float z = depth.at<float>(v, u);
        count += std::abs(z - 1) > 0.03f && std::abs(z - 1.35f) > 0.03f;
      }
    return count;
  };
  // 2 cm and 4 cm of the way: 7 and 15 pixels at both upright edges of 120 rows.
  const int still = spoilt(0), slow = spoilt(1), fast = spoilt(2);
  EXPECT_LT(still, 400);
  EXPECT_GT(slow, still + 500);
  EXPECT_GT(fast, slow + 500);
}

TEST(Sensors, RowsOfAScanAreSeenAtTheirOwnMoments) {
  Sensor l515 = unregistered("l515");
  const cv::Mat depth = depthOf(l515, wallScene(2, 1), 1, 2);
  const auto edgeOf = [&](int v) {
    for (int u = 0; u < depth.cols; ++u)
      if (depth.at<float>(v, u) > 0 && depth.at<float>(v, u) < 1.1f) return u;
    return -1;
  };
  // 150 rows are 9.4 ms, in which the camera goes 1.9 cm: 8.6 pixels at 1 m.
  EXPECT_NEAR(edgeOf(165) - edgeOf(315), 8.6, 2.1);
}

TEST(Sensors, TimeOfFlightLosesFarObliqueSurfaces) {
  EXPECT_GT(validShare(depthOf(unregistered("azure"), wallScene(2)), {220, 180, 200, 200}), 0.99);
  Scene dark = wallScene(3.5);
  dark.materials[0].rgb = {15, 15, 15};
  EXPECT_LT(validShare(depthOf(unregistered("azure"), dark), {220, 180, 200, 200}), 0.1);
}

TEST(Sensors, AzuresImageIsAHexagon) {
  const cv::Mat depth = depthOf(unregistered("azure"), wallScene(1.5));
  EXPECT_LT(validShare(depth, {0, 0, 60, 60}), 0.01);
  EXPECT_LT(validShare(depth, {580, 516, 60, 60}), 0.01);
  EXPECT_GT(validShare(depth, {200, 5, 240, 40}), 0.9);
  EXPECT_GT(validShare(depth, {5, 260, 40, 50}), 0.9);
}

TEST(Sensors, PhoneSeesNothingBelowItsSpacing) {
  // A pole 3 cm wide at 1 m is 6 pixels across, the points are 10.7 apart: it cannot come out at its depth
  // along its whole length, as a panel does.
  Scene scene = wallScene(1.5, 1);
  const ShapeBuilder shapes(scene, Eigen::Isometry3d::Identity());
  shapes.quad({0.455, -0.2, 1}, {0, 0.4, 0}, {0.01, 0, 0}, 0);
  paintVertices(scene);
  const cv::Mat depth = depthOf(sensorNamed("iphone"), scene);
  EXPECT_NEAR(cv::mean(depth(cv::Rect(118, 86, 20, 20)))[0], 1, 0.02);
  double low = 0, high = 0;
  cv::minMaxLoc(depth(cv::Rect(222, 60, 4, 70)), &low, &high);
  EXPECT_GT(high, 1.25);
  EXPECT_EQ(cv::countNonZero(depth == 0), 0);
  // Edges are slopes of several pixels.
  int between = 0;
  for (int u = 128; u < 210; ++u) between += depth.at<float>(96, u) > 1.05f && depth.at<float>(96, u) < 1.45f;
  EXPECT_GE(between, 3);
}

TEST(Sensors, SameSeedSameImagesOnAnyNumberOfThreads) {
  for (const char* name : {"kinect2", "d400", "f200", "iphone"}) {
    SynthOptions options = smallOptions(3, 2);
    options.sensor = sensorNamed(name);
    options.colour = true;
    options.scene = SceneKind::Desk;
    options.motion = Motion::Around;
    options.threads = 1;
    const SynthSequence one = makeSequence(options);
    options.threads = 3;
    const SynthSequence three = makeSequence(options);
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(cv::norm(one.frames[i].depth, three.frames[i].depth, cv::NORM_INF), 0) << name;
      EXPECT_EQ(cv::norm(one.frames[i].colour, three.frames[i].colour, cv::NORM_INF), 0) << name;
    }
    EXPECT_EQ(one.intrinsics, options.sensor.output()) << name;
    EXPECT_EQ(one.frames[0].depth.size(), cv::Size(one.intrinsics.width, one.intrinsics.height)) << name;
    EXPECT_GT(cv::norm(one.frames[0].depth, one.frames[1].depth, cv::NORM_INF), 0) << name;
  }
}

/// Sequences of earlier versions can be made again: kinect1 in a room is what it was before there were other
/// sensors.
TEST(Sensors, Kinect1IsTrueDepthWithHandasNoise) {
  SynthOptions options = smallOptions(4, 3);
  options.colour = true;
  const SynthPlan plan(options);
  const Frame frame = plan.renderFrame(2);
  const Pose& pose = plan.truth()[2].world_from_camera;
  Rng rng(4, 1002);
  cv::Mat depth;
  addHandaNoise(renderDepth(plan.tracer(), options.intrinsics, pose, 10), rng)
      .convertTo(depth, CV_16UC1, 5000);
  cv::Mat colour = renderColour(plan.tracer(), options.intrinsics, pose);
  addColourNoise(colour, rng);
  EXPECT_EQ(cv::norm(frame.depth, depth, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(frame.colour, colour, cv::NORM_INF), 0);
  EXPECT_EQ(makeRoom(1).mesh.vertices.size(), 52377u);
}

}  // namespace test_sensors
}  // namespace rosefusion::testing
