// 7-Scenes, Replica and FastCaMo (folder and packed file).
#include <gmock/gmock.h>

#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>

#include "host/datasets/sequence.h"
#include "tests/host/datasets/fixtures.h"

namespace rosefusion::testing {
namespace test_formats {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kQuarterTurn = "0 -1 0 0.5\n1 0 0 -0.25\n0 0 1 2\n0 0 0 1\n";

std::uint16_t firstPixel(Sequence& sequence, std::size_t index) {
  Frame frame;
  std::string problem;
  EXPECT_TRUE(sequence.read(index, frame, problem)) << problem;
  return frame.depth.empty() ? std::uint16_t{0} : frame.depth.at<std::uint16_t>(0, 0);
}

void makeSevenScenes(const TemporaryFolder& folder) {
  int n = 0;
  for (const char* number : {"000000", "000002", "000010"}) {
    const std::string stem = "frame-" + std::string(number);
    folder.writeImage(stem + ".depth.png", depthImage(1500 + n++));
    folder.write(stem + ".pose.txt", kQuarterTurn);
  }
}

TEST(SevenScenes, StampsComeFromTheFrameNumbers) {
  const TemporaryFolder folder;
  makeSevenScenes(folder);
  folder.writeImage("frame-000002.color.jpg", colourImage(200));
  const auto sequence = openSequence(folder.path());
  const SequenceInfo& info = sequence->info();
  EXPECT_EQ(info.format, "7-Scenes");
  EXPECT_EQ(info.depth_units_per_metre, 1000);
  ASSERT_EQ(sequence->size(), 3u);
  EXPECT_DOUBLE_EQ(sequence->timestamp(1), 2 / 30.0);
  EXPECT_DOUBLE_EQ(sequence->timestamp(2), 10 / 30.0);
  EXPECT_EQ(firstPixel(*sequence, 2), 1502);
  EXPECT_TRUE(info.has_colour);
  EXPECT_TRUE(info.intrinsics_assumed);
  EXPECT_DOUBLE_EQ(info.intrinsics.fx, 585 * 32 / 640.0);
  ASSERT_EQ(info.truth.size(), 3u);
  EXPECT_DOUBLE_EQ(info.truth[2].timestamp, 10 / 30.0);
  const Pose& pose = info.truth[2].world_from_camera;
  EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(0.5, -0.25, 2)));
  EXPECT_TRUE((pose.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
}

TEST(SevenScenes, IntrinsicsFileIsRead) {
  const TemporaryFolder folder;
  makeSevenScenes(folder);
  folder.write("camera-intrinsics.txt", "2.9e+01 0 1.6e+01\n0 2.8e+01 1.2e+01\n0 0 1\n");
  const auto sequence = openSequence(folder.path());
  EXPECT_EQ(sequence->info().intrinsics, (Intrinsics{kWidth, kHeight, 29, 28, 16, 12}));
  EXPECT_FALSE(sequence->info().intrinsics_assumed);
}

TEST(SevenScenes, BadPosesAreLeftOutWithAWarning) {
  const TemporaryFolder folder;
  makeSevenScenes(folder);
  folder.write("frame-000000.pose.txt", "nan nan nan nan\nnan nan nan nan\nnan nan nan nan\n0 0 0 1\n");
  folder.write("frame-000002.pose.txt",
               "2 0 0 0\n0 2 0 0\n0 0 2 0\n0 0 0 1\n");  // a scale is no rigid transform
  const auto sequence = openSequence(folder.path());
  ASSERT_EQ(sequence->info().truth.size(), 1u);
  EXPECT_DOUBLE_EQ(sequence->info().truth[0].timestamp, 10 / 30.0);
  EXPECT_THAT(sequence->info().warnings, ::testing::Contains(HasSubstr("frame-000000.pose.txt")));
  EXPECT_THAT(sequence->info().warnings, ::testing::Contains(HasSubstr("2 such pose files")));
}

void makeReplica(const TemporaryFolder& folder) {
  for (int i = 0; i < 3; ++i) {
    const std::string number = "00000" + std::to_string(i);
    folder.writeImage("results/depth" + number + ".png", depthImage(9000 + i));
    folder.writeImage("results/frame" + number + ".jpg", colourImage(90));
  }
  folder.write("traj.txt",
               "1.000000000000000000e+00 0 0 1.5 0 1 0 2.5 0 0 1 3.5 0 0 0 1\n"
               "broken 0 0 1.5 0 1 0 2.5 0 0 1 3.5 0 0 0 1\n"
               "0 -1 0 0.5 1 0 0 -0.25 0 0 1 2 0 0 0 1\n");
}

TEST(Replica, ReadsTheParametersBesideOrAboveTheScene) {
  for (const std::string& where : {std::string("cam_params.json"), std::string("../cam_params.json")}) {
    const TemporaryFolder folder("room0");
    makeReplica(folder);
    folder.write(
        where,
        R"({"camera": {"w": 32, "h": 24, "fx": 16.0, "fy": 16.5, "cx": 15.5, "cy": 11.5, "scale": 6553.5}})");
    const auto sequence = openSequence(folder.path(), {.colour = true});
    const SequenceInfo& info = sequence->info();
    EXPECT_EQ(info.format, "Replica (NICE-SLAM)");
    EXPECT_EQ(info.intrinsics, (Intrinsics{32, 24, 16.0, 16.5, 15.5, 11.5})) << where;
    EXPECT_FALSE(info.intrinsics_assumed);
    EXPECT_EQ(info.depth_units_per_metre, 6553.5);
    ASSERT_EQ(sequence->size(), 3u);
    EXPECT_DOUBLE_EQ(sequence->timestamp(2), 2 / 30.0);
    EXPECT_EQ(firstPixel(*sequence, 2), 9002);
    EXPECT_TRUE(info.has_colour);
    ASSERT_EQ(info.truth.size(), 2u);
    EXPECT_DOUBLE_EQ(info.truth[1].timestamp, 2 / 30.0) << "a skipped pose must not shift the ones behind it";
    EXPECT_TRUE(info.truth[0].world_from_camera.translation().isApprox(Eigen::Vector3d(1.5, 2.5, 3.5)));
    EXPECT_THAT(info.warnings, ElementsAre(HasSubstr("line 2")));
  }
}

TEST(Replica, ParametersForAnotherImageSizeAreRefused) {
  const TemporaryFolder folder("room0");
  makeReplica(folder);
  folder.write(
      "cam_params.json",
      R"({"camera": {"w": 1200, "h": 680, "fx": 600.0, "fy": 600.0, "cx": 599.5, "cy": 339.5, "scale": 6553.5}})");
  EXPECT_THAT(openingError(folder.path()),
              AllOf(HasSubstr("cam_params.json"), HasSubstr("1200x680"), HasSubstr("32x24")));
}

TEST(Replica, DamagedParametersAreOneSentence) {
  const TemporaryFolder folder("room0");
  makeReplica(folder);
  folder.write("cam_params.json", R"({"camera": {"w": 32, "h": 24}})");
  EXPECT_THAT(openingError(folder.path()), AllOf(HasSubstr("cam_params.json"), HasSubstr("expected")));
}

TEST(FastCaMo, FolderIsInMillimetresColourFirst) {
  const TemporaryFolder folder("apartment_1");
  std::string list;
  for (int i = 0; i < 2; ++i) {
    const std::string n = std::to_string(i);
    list += "0." + n + " color/" + n + ".png 0." + n + "5 depth/" + n + ".png\n";
    folder.writeImage("depth/" + n + ".png", depthImage(1200 + i, 640, 480));
    folder.writeImage("color/" + n + ".png", colourImage(i, 640, 480));
  }
  folder.write("associations.txt", list);
  const auto sequence = openSequence(folder.path(), {.colour = true});
  const SequenceInfo& info = sequence->info();
  EXPECT_EQ(info.format, "FastCaMo");
  EXPECT_EQ(info.depth_units_per_metre, 1000);
  EXPECT_EQ(info.intrinsics, (Intrinsics{640, 480, 320, 320, 319.5, 239.5}));
  EXPECT_TRUE(info.intrinsics_assumed);
  EXPECT_FALSE(info.notes.empty()) << "the guess must be told";
  ASSERT_EQ(sequence->size(), 2u);
  EXPECT_DOUBLE_EQ(sequence->timestamp(1), 0.15);
  EXPECT_EQ(firstPixel(*sequence, 1), 1201);
}

/// The bytes of a packed file with three frames whose depth is base + frame number.
std::string packedSeq(std::int32_t frames_in_header) {
  std::string bytes(12, '\0');
  const std::int32_t header[3] = {frames_in_header, kHeight, kWidth};
  std::memcpy(bytes.data(), header, sizeof header);
  for (int i = 0; i < 3; ++i) {
    const cv::Mat depth = depthImage(1000 + i), colour = colourImage(30 + i);
    bytes.append(reinterpret_cast<const char*>(depth.data), depth.total() * depth.elemSize());
    bytes.append(reinterpret_cast<const char*>(colour.data), colour.total() * colour.elemSize());
  }
  return bytes;
}

TEST(PackedSeq, SeeksToAnyFrame) {
  const TemporaryFolder folder;
  folder.write("gym.seq", packedSeq(3));
  folder.write("gym.txt", "0.0 1 2 3 0 0 0 1\n");
  for (const auto& path : {folder.path() / "gym.seq", folder.path()}) {  // the only one in its folder
    const auto sequence = openSequence(path, {.colour = true});
    const SequenceInfo& info = sequence->info();
    EXPECT_EQ(info.format, "FastCaMo packed .seq");
    EXPECT_EQ(info.intrinsics.width, kWidth);
    EXPECT_EQ(info.intrinsics.height, kHeight);
    EXPECT_DOUBLE_EQ(info.intrinsics.fx, 16);
    EXPECT_EQ(info.depth_units_per_metre, 1000);
    EXPECT_EQ(info.truth.size(), 1u);
    ASSERT_EQ(sequence->size(), 3u);
    for (const std::size_t i : {2u, 0u, 1u}) {
      Frame frame;
      std::string problem;
      ASSERT_TRUE(sequence->read(i, frame, problem)) << problem;
      EXPECT_DOUBLE_EQ(frame.timestamp, static_cast<double>(i) / 30);
      EXPECT_EQ(cv::countNonZero(frame.depth != depthImage(1000 + static_cast<int>(i))), 0);
      EXPECT_EQ(frame.colour.at<cv::Vec3b>(23, 31), cv::Vec3b(10, 20, static_cast<unsigned char>(30 + i)));
    }
  }
}

TEST(PackedSeq, ASizeThatContradictsTheHeaderIsRefused) {
  const TemporaryFolder folder;
  folder.write("cut.seq", packedSeq(3));
  folder.truncate("cut.seq", 0.9);
  EXPECT_THAT(openingError(folder.path() / "cut.seq"), AllOf(HasSubstr("cut.seq"), HasSubstr("needs 11532")));
  folder.write("more.seq", packedSeq(4));
  EXPECT_THAT(openingError(folder.path() / "more.seq"), HasSubstr("4 frames"));
  folder.write("zero.seq", std::string(12, '\0'));
  EXPECT_THAT(openingError(folder.path() / "zero.seq"), HasSubstr("no FastCaMo .seq"));
  folder.write("short.seq", "abc");
  EXPECT_THAT(openingError(folder.path() / "short.seq"), HasSubstr("header"));
  EXPECT_THAT(openingError(folder.path()), HasSubstr("4 recordings"))
      << "which one is meant is the user's to say";
}

TEST(PackedSeq, AFileThatShrinksWhileOpenIsABadFrame) {
  const TemporaryFolder folder;
  folder.write("gym.seq", packedSeq(3));
  const auto sequence = openSequence(folder.path() / "gym.seq");
  folder.truncate("gym.seq", 0.5);
  Frame frame;
  std::string problem;
  EXPECT_FALSE(sequence->read(2, frame, problem));
  EXPECT_THAT(problem, AllOf(HasSubstr("gym.seq"), HasSubstr("frame 2")));
  EXPECT_TRUE(sequence->read(0, frame, problem)) << "the frames before it stay readable";
}

}  // namespace test_formats
}  // namespace rosefusion::testing
