// Stored keyframes come back bit by bit, and stay within their limit.
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "host/slam/loop_closure/keyframe_images.h"

namespace rosefusion::testing {
namespace test_keyframe_images {

Frame noisyFrame(int number, bool colour) {
  cv::RNG rng(static_cast<std::uint64_t>(number) + 1);
  Frame frame;
  frame.timestamp = number;
  frame.depth = cv::Mat(48, 64, CV_16UC1);
  rng.fill(frame.depth, cv::RNG::UNIFORM, 1000, 1200);
  if (!colour) return frame;
  frame.colour = cv::Mat(48, 64, CV_8UC3);
  rng.fill(frame.colour, cv::RNG::UNIFORM, 0, 255);
  return frame;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(KeyframeImages, GivesBackWhatItWasGiven) {
  KeyframeImages store(1 << 20);
  for (const bool colour : {false, true}) store.add(noisyFrame(colour, colour), colour);
  for (const bool colour : {false, true}) {
    const Frame back = store.frame(colour);
    EXPECT_TRUE(same(back.depth, noisyFrame(colour, colour).depth));
    EXPECT_EQ(back.colour.empty(), !colour);
    EXPECT_EQ(back.timestamp, colour);
  }
  EXPECT_TRUE(same(store.frame(1).colour, noisyFrame(1, true).colour));
  EXPECT_LT(store.bytes(), 2 * 48 * 64 * 2 + 48 * 64 * 3 + 1000u) << "noise of 200 steps fits into a byte";
}

TEST(KeyframeImages, ThinsWhereTheWayIsDensest) {
  constexpr std::uint64_t kLimit = 60000;
  KeyframeImages store(kLimit);
  double travelled = 0;
  for (int i = 0; i < 60; ++i) {
    store.add(noisyFrame(i, false), travelled);
    EXPECT_LE(store.bytes(), kLimit);
    EXPECT_TRUE(store.has(store.size() - 1)) << "the newest";
    travelled += i < 30 ? 0.1 : 0.5;
  }
  EXPECT_TRUE(store.has(0));
  int slow = 0, fast = 0;
  for (std::size_t i = 0; i < 60; ++i) (i < 30 ? slow : fast) += store.has(i);
  EXPECT_GT(slow + fast, 5);
  EXPECT_LT(slow, fast) << "30 keyframes on 3 m thin before 30 on 15 m";
  for (std::size_t i = 0; i < 60; ++i)
    if (store.has(i)) {
      EXPECT_TRUE(same(store.frame(i).depth, noisyFrame(static_cast<int>(i), false).depth)) << i;
    }
}

}  // namespace test_keyframe_images
}  // namespace rosefusion::testing
