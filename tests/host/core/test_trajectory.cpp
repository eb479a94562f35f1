#include "host/core/trajectory.h"

#include <gmock/gmock.h>

#include "tests/host/core/temporary_folder.h"

namespace rosefusion::testing {
namespace test_trajectory {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

Pose pose(double x, double y, double z, double angle, const Eigen::Vector3d& axis) {
  Pose p = Pose::Identity();
  p.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  p.translation() = Eigen::Vector3d(x, y, z);
  return p;
}

TEST(ReadTumTrajectory, ReadsStampPositionAndRotation) {
  const TemporaryFolder folder;
  const auto file = folder.write("t.txt",
                                 "# a comment\n\n"
                                 "1305031225.9334 1 -2 3.5 0 0 0.70710678 0.70710678\n"
                                 "  1305031226.0,4,5,6,0,0,0,2  \r\n"
                                 "   # another\n");
  const Trajectory t = readTumTrajectory(file);
  ASSERT_EQ(t.size(), 2u);
  EXPECT_DOUBLE_EQ(t[0].timestamp, 1305031225.9334);
  EXPECT_EQ(t[0].world_from_camera.translation(), Eigen::Vector3d(1, -2, 3.5));
  // A quarter turn about z, camera to world: the camera's x axis points along the world's y.
  EXPECT_NEAR((t[0].world_from_camera.linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(),
              0, 1e-8);
  EXPECT_TRUE(t[1].world_from_camera.linear().isIdentity(1e-15)) << "quaternions are normalised";
}

TEST(ReadTumTrajectory, SortsAndTellsThatItDid) {
  const TemporaryFolder folder;
  bool was_unsorted = false;
  const auto mixed = folder.write("mixed", "3 3 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n");
  const Trajectory t = readTumTrajectory(mixed, &was_unsorted);
  EXPECT_TRUE(was_unsorted);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(t[i].timestamp, static_cast<double>(i + 1));
    EXPECT_EQ(t[i].world_from_camera.translation().x(), t[i].timestamp) << "the pose goes with its stamp";
  }
  readTumTrajectory(folder.write("sorted", "1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n"), &was_unsorted);
  EXPECT_FALSE(was_unsorted);
}

TEST(ReadTumTrajectory, FileWithoutPosesIsAnEmptyTrajectory) {
  const TemporaryFolder folder;
  EXPECT_TRUE(readTumTrajectory(folder.write("empty", "")).empty());
  EXPECT_TRUE(readTumTrajectory(folder.write("comments", "# lost from the start\n")).empty());
}

struct Malformed {
  const char* name;
  const char* line;
  const char* reason;
};
void PrintTo(const Malformed& m, std::ostream* out) {
  *out << m.name;
}

class RejectsTumLine : public ::testing::TestWithParam<Malformed> {};

TEST_P(RejectsTumLine, NamingFileAndLine) {
  const TemporaryFolder folder;
  const auto file = folder.write(
      "bad.txt", std::string("# header\n1 0 0 0 0 0 0 1\n") + GetParam().line + "\n3 0 0 0 0 0 0 1\n");
  const std::string sentence = inputErrorOf([&] { readTumTrajectory(file); });
  EXPECT_THAT(sentence, AllOf(StartsWith(file.string() + ":3: "), HasSubstr(GetParam().reason)));
}

INSTANTIATE_TEST_SUITE_P(
    Trajectory, RejectsTumLine,
    ::testing::Values(Malformed{"ShortLine", "2 0 0 0 0 0 0", "not a TUM pose"},
                      Malformed{"Matrix", "1 0 0 0 0 1 0 0 0 0 1 0", "not a TUM pose"},
                      Malformed{"Word", "2 0 0 zero 0 0 0 1", "not a TUM pose"},
                      Malformed{"NumberWithTail", "2 0 0 0.5m 0 0 0 1", "not a TUM pose"},
                      Malformed{"NotANumber", "2 0 nan 0 0 0 0 1", "not finite"},
                      Malformed{"Infinite", "inf 0 0 0 0 0 0 1", "not finite"},
                      Malformed{"Overflow", "2 1e999 0 0 0 0 0 1", "not finite"},
                      Malformed{"ZeroQuaternion", "2 0 0 0 0 0 0 0", "quaternion is zero"}),
    [](const auto& tested) { return tested.param.name; });

TEST(ReadTumTrajectory, NamesWhatCannotBeRead) {
  const TemporaryFolder folder;
  EXPECT_THAT(inputErrorOf([&] { readTumTrajectory(folder / "absent.txt"); }),
              AllOf(StartsWith((folder / "absent.txt").string()), HasSubstr("cannot be opened")));
  EXPECT_THAT(inputErrorOf([&] { readTumTrajectory(folder.path()); }),
              AllOf(StartsWith(folder.path().string()), HasSubstr("is a folder")));
}

TEST(WriteTumTrajectory, ReadingGivesTheSameBack) {
  const TemporaryFolder folder;
  const Trajectory written{{1305031225.123456, pose(1.23456789, -2, 3, 3.1, {1, 2, 3})},
                           {1305031225.156789, pose(-100, 0, 1e-6, -0.2, {0, 1, 0})}};
  writeTumTrajectory(folder / "t.txt", written);
  const Trajectory read = readTumTrajectory(folder / "t.txt");
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(read[i].timestamp, written[i].timestamp, 1e-6);
    EXPECT_TRUE(read[i].world_from_camera.isApprox(written[i].world_from_camera, 1e-8));
  }
}

TEST(WriteTumTrajectory, FailureNamesTheFile) {
  const TemporaryFolder folder;
  folder.write("plain", "");
  EXPECT_THAT(inputErrorOf([&] { writeTumTrajectory(folder / "plain" / "t.txt", {}); }),
              HasSubstr((folder / "plain").string()));
}

class Interpolate : public ::testing::Test {
 protected:
  // A turn of 90 degrees over the first second, then a gap of five.
  const Trajectory trajectory_{{10, pose(0, 0, 0, 0, {0, 0, 1})},
                               {11, pose(2, -4, 0, std::acos(0.0), {0, 0, 1})},
                               {16, pose(2, -4, 5, std::acos(0.0), {0, 0, 1})}};
  Pose result_;
};

TEST_F(Interpolate, IsLinearInPositionAndEvenInRotation) {
  ASSERT_TRUE(interpolate(trajectory_, 10.25, 1, result_));
  EXPECT_TRUE(result_.isApprox(pose(0.5, -1, 0, std::acos(0.0) / 4, {0, 0, 1}), 1e-12));
  EXPECT_TRUE(result_.matrix().row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1)));
}

TEST_F(Interpolate, HitsThePosesThemselves) {
  for (const StampedPose& p : trajectory_) {
    ASSERT_TRUE(interpolate(trajectory_, p.timestamp, 0.1, result_)) << p.timestamp;
    EXPECT_TRUE(result_.isApprox(p.world_from_camera, 1e-12)) << p.timestamp;
  }
}

TEST_F(Interpolate, RefusesGapsAndTimesBeyondTheEnds) {
  EXPECT_FALSE(interpolate(trajectory_, 13, 1, result_));
  EXPECT_TRUE(interpolate(trajectory_, 13, 5, result_));
  EXPECT_FALSE(interpolate(trajectory_, 9.8, 0.1, result_));
  EXPECT_TRUE(interpolate(trajectory_, 9.95, 0.1, result_));
  EXPECT_FALSE(interpolate(trajectory_, 16.2, 0.1, result_));
  EXPECT_FALSE(interpolate(trajectory_, std::nan(""), 5, result_));
  EXPECT_FALSE(interpolate({}, 10, 5, result_));
}

TEST_F(Interpolate, TakesTheShortWayRound) {
  // q and -q are one rotation: between nearly equal rotations nothing may turn the long way.
  const Trajectory turn{{0, pose(0, 0, 0, 3.1, {0, 0, 1})}, {1, pose(0, 0, 0, 3.3, {0, 0, 1})}};
  ASSERT_TRUE(interpolate(turn, 0.5, 1, result_));
  EXPECT_TRUE(result_.isApprox(pose(0, 0, 0, 3.2, {0, 0, 1}), 1e-12));
}

}  // namespace test_trajectory
}  // namespace rosefusion::testing
