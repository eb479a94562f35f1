#include "host/slam/mapping/kept_frames.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace rosefusion::testing {
namespace test_kept_frames {

Pose at(double x) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x;
  return pose;
}

Frame frameOf(int side) {
  return {0, cv::Mat(side, side, CV_16UC1, cv::Scalar(1000)), {}, {}};
}

std::vector<std::size_t> numbersOf(const KeptFrames& frames) {
  std::vector<std::size_t> out;
  for (const KeptFrames::Kept& kept : frames.all()) out.push_back(kept.number);
  return out;
}

TEST(KeptFrames, LieApart) {
  LoopSettings settings;  // 15 cm
  KeptFrames frames(settings);
  const Frame shown = frameOf(8);
  for (std::size_t i = 0; i < 10; ++i) frames.offer(shown, at(0.04 * static_cast<double>(i)), i);
  EXPECT_EQ(numbersOf(frames), (std::vector<std::size_t>{0, 4, 8}));
  EXPECT_NE(frames.all()[0].frame.depth.data, shown.depth.data) << "the caller's image may change";
}

TEST(KeptFrames, BeyondTheLimitEverySecondGoes) {
  LoopSettings settings;
  settings.memory_mb = 1;  // of images of 128 KiB: 8
  KeptFrames frames(settings);
  for (std::size_t i = 0; i < 16; ++i) frames.offer(frameOf(256), at(0.25 * static_cast<double>(i)), i);
  EXPECT_EQ(numbersOf(frames), (std::vector<std::size_t>{0, 2, 4, 6, 8, 10, 12, 14}));
  for (std::size_t i = 16; i < 18; ++i) frames.offer(frameOf(256), at(0.25 * static_cast<double>(i)), i);
  EXPECT_EQ(numbersOf(frames), (std::vector<std::size_t>{0, 4, 8, 12, 16}));
}

TEST(KeptFrames, APoseThatComesInMovesTheNumbersBehindIt) {
  KeptFrames frames(LoopSettings{});
  for (std::size_t i = 0; i < 3; ++i) frames.offer(frameOf(8), at(static_cast<double>(i)), i);
  frames.renumber(1);
  EXPECT_EQ(numbersOf(frames), (std::vector<std::size_t>{0, 2, 3}));
}

}  // namespace test_kept_frames
}  // namespace rosefusion::testing
