// What is recorded is what came, and what was recorded so far is never lost.
#include "host/run/recording.h"

#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/core.hpp>

#include "host/core/error.h"
#include "host/datasets/sequence.h"
#include "tests/host/core/temporary_folder.h"

namespace rosefusion::testing {
namespace test_recording {

namespace fs = std::filesystem;

class Recording : public ::testing::Test {
 protected:
  Recording() {
    info_.path = "openni2:";
    info_.format = "camera";
    info_.intrinsics = {64, 48, 50.125, 50.25, 31.5, 23.5};
    info_.depth_units_per_metre = 8000;
  }
  static Frame frameAt(double timestamp, int depth, bool colour = true) {
    return {timestamp,
            cv::Mat(48, 64, CV_16UC1, cv::Scalar(depth)),
            colour ? cv::Mat(48, 64, CV_8UC3, cv::Scalar(1, 2, depth % 256)) : cv::Mat(),
            {}};
  }
  TemporaryFolder folder_;
  SequenceInfo info_;
};

TEST_F(Recording, IsReadBackBitForBit) {
  info_.truth = {{2, Pose::Identity()}, {2.1, Pose::Identity()}};
  RecordingWriter writer(folder_ / "out", info_);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(writer.add(frameAt(2 + 0.033333 * i, 1000 + i)));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  writer.finish();
  EXPECT_FALSE(fs::exists(folder_ / "out.part"));

  SequenceOptions options;
  options.colour = true;
  const auto read = openSequence(folder_ / "out", options);
  ASSERT_EQ(read->size(), 4u);
  EXPECT_EQ(read->info().depth_units_per_metre, 8000);
  EXPECT_EQ(read->info().intrinsics.fx, 50.125);
  EXPECT_EQ(read->info().truth.size(), 2u);
  for (std::size_t i = 0; i < 4; ++i) {
    Frame frame;
    std::string problem;
    ASSERT_TRUE(read->read(i, frame, problem)) << problem;
    EXPECT_NEAR(read->timestamp(i), 2 + 0.033333 * static_cast<double>(i), 1e-6);
    const Frame told = frameAt(0, 1000 + static_cast<int>(i));
    EXPECT_EQ(cv::norm(frame.depth, told.depth, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(frame.colour, told.colour, cv::NORM_INF), 0);
  }
}

TEST_F(Recording, StampsThatDoNotGrowAreLeftOut) {
  info_.seconds_per_stamp = 0.5;
  RecordingWriter writer(folder_ / "out", info_);
  EXPECT_TRUE(writer.add(frameAt(4, 1, false)));
  EXPECT_FALSE(writer.add(frameAt(4, 2, false)));
  EXPECT_FALSE(writer.add(frameAt(3, 3, false)));
  EXPECT_TRUE(writer.add(frameAt(5, 4, false)));
  writer.finish();
  const auto read = openSequence(folder_ / "out");
  ASSERT_EQ(read->size(), 2u);
  EXPECT_EQ(read->timestamp(1), 2.5) << "in seconds";
  EXPECT_FALSE(read->info().has_colour);
}

// As after a power cut: what is there can be used, and the next recording does not take its place.
TEST_F(Recording, OneThatWasNotFinishedIsKept) {
  {
    RecordingWriter writer(folder_ / "out", info_);
    writer.add(frameAt(1, 7));
  }
  EXPECT_EQ(openSequence(folder_ / "out.part")->size(), 1u);
  EXPECT_THROW(RecordingWriter(folder_ / "out", info_), InputError);
  fs::rename(folder_ / "out.part", folder_ / "kept");
  RecordingWriter(folder_ / "out", info_);  // of nothing, nothing stays
  EXPECT_FALSE(fs::exists(folder_ / "out.part"));
}

TEST_F(Recording, WhatIsThereIsNotReplaced) {
  fs::create_directories(folder_ / "out");
  std::ofstream(folder_ / "out" / "mine.txt") << "x";
  EXPECT_THROW(RecordingWriter::requireUsable(folder_ / "out"), InputError);
}

}  // namespace test_recording
}  // namespace rosefusion::testing
