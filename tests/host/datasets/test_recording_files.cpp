// Recordings in one file: ScanNet's .sens, ElasticFusion's .klg and Record3D's .r3d, the small ones of
// tests/fixtures/recordings, written by its Python script.
#include <gmock/gmock.h>

#include <cstring>

#include "host/core/error.h"
#include "host/datasets/byte_reader.h"
#include "host/datasets/lzfse.h"
#include "host/datasets/sequence.h"
#include "tests/host/datasets/fixtures.h"

namespace rosefusion::testing {
namespace test_recording_files {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
namespace fs = std::filesystem;

const fs::path kFixtures = fs::path(ROSEFUSION_SOURCE_DIR) / "tests/fixtures/recordings";

class RecordingFile : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Kinds, RecordingFile,
                         ::testing::Values("small.sens", "raw.sens", "small.klg", "small.r3d"));

TEST_P(RecordingFile, GivesTheSourcesImagesStampsAndColour) {
  SequenceOptions options;
  options.colour = true;
  const auto sequence = openSequence(kFixtures / GetParam(), options);
  const SequenceInfo& info = sequence->info();
  EXPECT_EQ(info.intrinsics.width, kWidth);
  EXPECT_EQ(info.intrinsics.height, kHeight);
  EXPECT_TRUE(info.has_colour);
  ASSERT_EQ(sequence->size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(sequence->timestamp(i), 10 + 0.1 * static_cast<double>(i), 1e-6);
    Frame frame;
    std::string problem;
    ASSERT_TRUE(sequence->read(i, frame, problem)) << problem;
    EXPECT_EQ(problem, "");
    ASSERT_EQ(frame.depth.type(), CV_16UC1);
    const cv::Mat expected = depthImage(1500 + static_cast<int>(i));
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) {
        if (info.format == "Record3D" && v == 3 && u == 7) continue;  // see its own test
        ASSERT_NEAR(frame.depth.at<std::uint16_t>(v, u) / info.depth_units_per_metre,
                    expected.at<std::uint16_t>(v, u) / 1000.0, 1e-4);
      }
    ASSERT_EQ(frame.colour.size(), frame.depth.size());
    EXPECT_NEAR(frame.colour.at<cv::Vec3b>(5, 5)[2], 200, 3);
    EXPECT_NEAR(frame.colour.at<cv::Vec3b>(5, 5)[0], 10, 3);
  }
}

TEST_P(RecordingFile, DamagedOnesEndInASentence) {
  EXPECT_GT(openDamagedVariants(kFixtures / GetParam()), 100)
      << "most damage must be lived with, or the test shows little";
}

TEST(SensFile, CameraAndTruth) {
  const auto sequence = openSequence(kFixtures / "small.sens");
  const SequenceInfo& info = sequence->info();
  EXPECT_EQ(info.intrinsics, (Intrinsics{kWidth, kHeight, 30, 31, 16, 12}));
  EXPECT_FALSE(info.intrinsics_assumed);
  EXPECT_EQ(info.depth_units_per_metre, 1000);
  EXPECT_THAT(info.warnings, IsEmpty());
  ASSERT_EQ(info.truth.size(), 2u) << "the second pose is unknown (-inf)";
  EXPECT_NEAR(info.truth[1].timestamp, 10.2, 1e-6);
  EXPECT_TRUE(info.truth[1].world_from_camera.translation().isApprox(Eigen::Vector3d(0.5, -0.25, 2)));
}

TEST(SensFile, WhatIsCutIsReadUpToThere) {
  const TemporaryFolder folder;
  for (const char* name : {"small.sens", "small.klg"}) {
    const std::string whole = fileBytes(kFixtures / name);
    folder.write(name, whole.substr(0, whole.size() - 700));
    const auto sequence = openSequence(folder.path() / name);
    EXPECT_EQ(sequence->size(), 2u);
    EXPECT_THAT(sequence->info().warnings, Contains(HasSubstr("2 of 3 frames are there")));
  }
}

TEST(SensFile, WithoutStampsItsFramesAreNumbered) {
  const TemporaryFolder folder;
  std::string bytes = fileBytes(kFixtures / "raw.sens");
  for (std::int64_t stamp = 10'000'000; stamp <= 10'200'000; stamp += 100'000) {
    const std::string raw(reinterpret_cast<const char*>(&stamp), 8);
    for (std::size_t at; (at = bytes.find(raw)) != bytes.npos;) bytes.replace(at, 8, 8, '\0');
  }
  folder.write("zero.sens", bytes);
  const auto sequence = openSequence(folder.path() / "zero.sens");
  EXPECT_DOUBLE_EQ(sequence->timestamp(2), 2 / 30.0);
  EXPECT_THAT(sequence->info().notes, Contains(HasSubstr("30 frames per second")));
}

TEST(SensFile, OtherVersionsAndCompressionsAreNamed) {
  const TemporaryFolder folder;
  std::string bytes = fileBytes(kFixtures / "raw.sens");
  bytes[0] = 3;
  folder.write("old.sens", bytes);
  EXPECT_THAT(openingError(folder.path() / "old.sens"), HasSubstr("version 4"));
  bytes[0] = 4;
  bytes[12 + 15 + 4 * 64 + 4] = 2;  // behind the name, the matrices and colour's code
  folder.write("occi.sens", bytes);
  EXPECT_THAT(openingError(folder.path() / "occi.sens"), HasSubstr("OCCI"));
}

TEST(KlgFile, ItsCameraIsAssumed) {
  const auto sequence = openSequence(kFixtures / "small.klg");
  EXPECT_TRUE(sequence->info().intrinsics_assumed);
  EXPECT_DOUBLE_EQ(sequence->info().intrinsics.fx, 528 * kWidth / 640.0);
}

TEST(KlgFile, ASizeThatNothingTellsIsAsked) {
  const TemporaryFolder folder;
  std::string bytes = fileBytes(kFixtures / "small.klg");
  for (std::size_t at; (at = bytes.find("\xff\xd8")) != bytes.npos;) bytes[at] = 0;  // no JPEG any more
  folder.write("blind.klg", bytes);
  EXPECT_THAT(openingError(folder.path() / "blind.klg"), HasSubstr("768 pixels"));
  SequenceOptions options;
  options.intrinsics = Intrinsics{kWidth, kHeight, 30, 31, 16, 12};
  EXPECT_EQ(openSequence(folder.path() / "blind.klg", options)->info().intrinsics.height, kHeight);
}

TEST(Record3dFile, CameraTruthAndConfidence) {
  const auto sequence = openSequence(kFixtures / "small.r3d");
  const SequenceInfo& info = sequence->info();
  EXPECT_DOUBLE_EQ(info.intrinsics.fx, 30) << "of an image twice as large";
  EXPECT_DOUBLE_EQ(info.intrinsics.cx, 33 / 2.0 - 0.5);
  EXPECT_FALSE(info.intrinsics_assumed);
  Frame frame;
  std::string problem;
  ASSERT_TRUE(sequence->read(2, frame, problem)) << problem;
  EXPECT_EQ(frame.depth.at<std::uint16_t>(3, 7), 0) << "its confidence is 0";
  ASSERT_EQ(info.truth.size(), 3u);
  const Pose& pose = info.truth[2].world_from_camera;
  EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(0.5, -0.25, 2)));
  EXPECT_TRUE((pose.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-9));
  EXPECT_TRUE((pose.linear() * Eigen::Vector3d::UnitZ()).isApprox(-Eigen::Vector3d::UnitZ(), 1e-9))
      << "ARKit's camera looks along -z";
}

TEST(Record3dFile, ACutOneNamesTheRemedy) {
  const TemporaryFolder folder;
  const std::string whole = fileBytes(kFixtures / "small.r3d");
  folder.write("cut.r3d", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(openingError(folder.path() / "cut.r3d"), HasSubstr("zip -FF"));
}

TEST(Lzfse, OverlappingCopiesRepeat) {
  // 'abc' as literals with a match of 7 three back, then two matches of the last distance: 271 and 19.
  const std::string stream =
      std::string("bvxn\x2c\1\0\0\x13\0\0\0\xc8\3abc\xf0\xff\xf0\x05\xe1\x63\6\0\0\0\0\0\0\0bvx$", 35);
  const auto packed = std::as_bytes(std::span(stream.data(), stream.size()));
  const auto out = datasets::unpackedLzfse(packed, 1000);
  std::string expected;
  for (int i = 0; i < 100; ++i) expected += "abc";
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(out.data()), out.size()), expected);
  EXPECT_THROW(datasets::unpackedLzfse(packed, 299), datasets::EndOfBytes) << "never more than was asked for";
}

}  // namespace test_recording_files
}  // namespace rosefusion::testing
