// ROS recordings: the small ones of tests/fixtures/recordings, written by its Python script, a real one of
// the RealSense SDK where it is at hand, and many damaged ones.
#include <gmock/gmock.h>
#include <zstd.h>

#include "host/core/error.h"
#include "host/datasets/byte_reader.h"
#include "host/datasets/compression.h"
#include "host/datasets/ros/ros_messages.h"
#include "host/datasets/sequence.h"
#include "tests/host/datasets/fixtures.h"

namespace rosefusion::testing {
namespace test_ros_recordings {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

const fs::path kFixtures = fs::path(ROSEFUSION_SOURCE_DIR) / "tests/fixtures/recordings";
const fs::path kData = fs::path(ROSEFUSION_SOURCE_DIR) / "../shared/data";

class RosRecording : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Kinds, RosRecording, ::testing::Values("small.bag", "small.db3", "small.mcap"));

TEST_P(RosRecording, GivesTheSourcesImagesStampsAndCamera) {
  SequenceOptions options;
  options.colour = true;
  const auto sequence = openSequence(kFixtures / GetParam(), options);
  const SequenceInfo& info = sequence->info();
  EXPECT_EQ(info.intrinsics, (Intrinsics{kWidth, kHeight, 30, 31, 16, 12}));
  EXPECT_FALSE(info.intrinsics_assumed);
  EXPECT_EQ(info.depth_units_per_metre, 1000);
  EXPECT_TRUE(info.has_colour);
  EXPECT_THAT(info.warnings, ::testing::IsEmpty());
  ASSERT_EQ(sequence->size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(sequence->timestamp(i), 10 + 0.1 * static_cast<double>(i), 1e-6);
    Frame frame;
    std::string problem;
    ASSERT_TRUE(sequence->read(i, frame, problem)) << problem;
    const cv::Mat expected = depthImage(1500 + static_cast<int>(i));
    EXPECT_EQ(cv::countNonZero(frame.depth != expected), 0);
    ASSERT_EQ(frame.colour.size(), frame.depth.size());
    EXPECT_EQ(frame.colour.at<cv::Vec3b>(5, 5), cv::Vec3b(10, 20, 200));
  }
}

TEST(RosRecordings, FloatingMetresKeepTheirPrecision) {
  const auto sequence = openSequence(kFixtures / "metres.bag");
  Frame frame;
  std::string problem;
  ASSERT_TRUE(sequence->read(2, frame, problem)) << problem;
  EXPECT_NEAR(frame.depth.at<std::uint16_t>(3, 7) / sequence->info().depth_units_per_metre,
              (1502 + 7 + 40 * 3) / 1000.0, 1e-4);
}

TEST(RosRecordings, LensesOfOpenCvsModelsAreKnown) {
  using datasets::Distortion;
  const auto lens = [](const char* model, std::vector<double> d) {
    datasets::CameraInfoMessage camera;
    camera.distortion_model = model;
    camera.distortion = std::move(d);
    return camera.lens();
  };
  EXPECT_EQ(lens("plumb_bob", {0, 0, 0, 0, 0}), Distortion{});
  EXPECT_EQ(lens("", {}), Distortion{});
  EXPECT_EQ(lens("Inverse Brown Conrady", {0, 0, 0, 0, 0}), Distortion{});
  EXPECT_EQ(lens("plumb_bob", {.1, .2, .3, .4}), (Distortion{.1, .2, .3, .4}));
  EXPECT_EQ(lens("rational_polynomial", {1, 2, 3, 4, 5, 6, 7, 8}), (Distortion{1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(lens("rational_polynomial", {1, 2, 3, 4, 5, 6, 7, 8, 0, 0, 0, 0}),
            (Distortion{1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_FALSE(lens("rational_polynomial", {1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 0, 0}));
  EXPECT_FALSE(lens("plumb_bob", {1, 2, 3, 4, 5, 6}));
  EXPECT_FALSE(lens("plumb_bob", {std::nan("")}));
  EXPECT_FALSE(lens("equidistant", {.1, .2, .3, .4}));
}

// A lens whose model is not known is told; one whose images were undistorted already is no matter.
TEST(RosRecordings, AnUnknownLensIsTold) {
  std::ifstream in(kFixtures / "small.bag", std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  TemporaryFolder folder;
  const std::string model = "plumb_bob";
  std::size_t changed = 0;
  for (auto at = bytes.find(model); at != std::string::npos; at = bytes.find(model, at + 1), ++changed) {
    bytes.replace(at, model.size(), "fisheye_1");
    bytes[at + model.size() + 4 + 7] = '\x40';  // the first of the coefficients, 2
  }
  ASSERT_GT(changed, 0u);
  std::ofstream(folder.path() / "bent.bag", std::ios::binary) << bytes;
  EXPECT_THAT(openSequence(folder.path() / "bent.bag")->info().warnings,
              ::testing::Contains(AllOf(HasSubstr("fisheye_1"), HasSubstr("image_rect"))));
}

TEST(RosRecordings, TheTopicCanBeChosen) {
  SequenceOptions options;
  options.topic = "/camera/depth/image_raw";
  EXPECT_EQ(openSequence(kFixtures / "small.bag", options)->size(), 3u);
  options.topic = "/nowhere";
  try {
    openSequence(kFixtures / "small.bag", options);
    FAIL() << "opened";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/camera/depth/image_raw")) << "what there is must be named";
  }
}

TEST(RosRecordings, ABagThatWasCutIsReadUpToThere) {
  const TemporaryFolder folder;
  const std::string whole = fileBytes(kFixtures / "small.bag");
  const std::size_t second_chunk = whole.rfind("compression=none");
  folder.write("cut.bag", whole.substr(0, second_chunk + 2000));
  const auto sequence = openSequence(folder.path() / "cut.bag");
  EXPECT_EQ(sequence->size(), 1u);
  EXPECT_THAT(sequence->info().warnings, ::testing::Contains(HasSubstr("read up to there")));
}

TEST(RosRecordings, ADamagedFirstImageCostsItselfAlone) {
  const TemporaryFolder folder;
  std::string bytes = fileBytes(kFixtures / "small.bag");
  bytes.replace(bytes.find("16UC1"), 2, "xx");
  folder.write("first.bag", bytes);
  const auto sequence = openSequence(folder.path() / "first.bag");
  ASSERT_EQ(sequence->size(), 3u);
  Frame frame;
  std::string problem;
  EXPECT_FALSE(sequence->read(0, frame, problem));
  EXPECT_THAT(problem, HasSubstr("first.bag"));
  EXPECT_TRUE(sequence->read(1, frame, problem)) << problem;
}

TEST_P(RosRecording, DamagedOnesEndInASentence) {
  EXPECT_GT(openDamagedVariants(kFixtures / GetParam()), 100)
      << "most damage must be lived with, or the test shows little";
}

TEST(RosRecordings, CompressedBlocksUnpack) {
  const std::string text(5000, 'x');
  std::vector<std::byte> packed(ZSTD_compressBound(text.size()));
  packed.resize(ZSTD_compress(packed.data(), packed.size(), text.data(), text.size(), 1));
  const auto out = datasets::unpackedZstd(packed, text.size());
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(out.data()), out.size()), text);
  packed.resize(packed.size() / 2);
  EXPECT_THROW(datasets::unpackedZstd(packed, text.size()), datasets::EndOfBytes);
}

TEST(RosRecordings, ARecordingOfTheRealSenseSdk) {
  const char* set = std::getenv("ROSEFUSION_DATA");
  const fs::path file = (set ? fs::path(set) : kData) / "realsense_bag/single_depth_color_640x480.bag";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not on this machine (set ROSEFUSION_DATA)";
  const auto sequence = openSequence(file);
  const SequenceInfo& info = sequence->info();
  ASSERT_EQ(sequence->size(), 2u);
  EXPECT_FALSE(info.has_colour) << "it is another camera's, beside the depth camera";
  EXPECT_EQ(info.intrinsics.width, 640);
  EXPECT_GT(info.intrinsics.fx, 300);
  EXPECT_NEAR(info.depth_units_per_metre, 1000, 1e-3);
  Frame frame;
  std::string problem;
  ASSERT_TRUE(sequence->read(0, frame, problem)) << problem;
  EXPECT_GT(cv::countNonZero(frame.depth), 640 * 480 / 4);
}

}  // namespace test_ros_recordings
}  // namespace rosefusion::testing
