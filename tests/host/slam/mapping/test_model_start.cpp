// What a model begins with: given up while a frame that follows tells more than what confirmed it.
#include "host/slam/mapping/model_start.h"

#include <gtest/gtest.h>

namespace rosefusion::testing {
namespace test_model_start {

Frame frameAt(double timestamp) {
  return {timestamp, cv::Mat(2, 2, CV_16UC1, cv::Scalar(1000)), {}, {}};
}

TEST(ModelStart, TwoFramesInARowThatFitNowhereAreARival) {
  ModelStart start;
  start.begin(frameAt(0), 0.4);
  EXPECT_FALSE(start.rival(frameAt(1), 0.9)) << "one alone may be the one that is wrong";
  const auto rival = start.rival(frameAt(2), 0.9);
  ASSERT_TRUE(rival);
  EXPECT_EQ(rival->frame.timestamp, 1);
  EXPECT_EQ(rival->told, 0.9);
  EXPECT_EQ(start.rival(frameAt(3), 0.9)->frame.timestamp, 2) << "the one before";
}

TEST(ModelStart, AFrameInBetweenThatFitsEndsTheRow) {
  ModelStart start;
  start.begin(frameAt(0), 0.4);
  start.rival(frameAt(1), 0.9);
  start.confirm(0.2);
  EXPECT_FALSE(start.rival(frameAt(3), 0.9));
}

TEST(ModelStart, ARivalMustOutweighTheConfirmation) {
  for (const double confirmed : {0.3, 0.5}) {
    ModelStart start;
    start.begin(frameAt(0), 0.8);
    start.confirm(confirmed);
    start.rival(frameAt(1), 0.9);
    EXPECT_EQ(start.rival(frameAt(2), 0.4).has_value(), confirmed < 0.4) << "the lesser of both counts";
  }
}

TEST(ModelStart, WhatAWholeImageHasConfirmedStays) {
  ModelStart start;
  start.begin(frameAt(0), 1);
  start.confirm(0.6);
  EXPECT_TRUE(start.first());
  start.confirm(0.6);
  EXPECT_FALSE(start.first()) << "its images are let go";
  start.rival(frameAt(3), 1);
  EXPECT_FALSE(start.rival(frameAt(4), 1));
}

TEST(ModelStart, KeepsImagesOfItsOwn) {
  ModelStart start;
  Frame frame = frameAt(0);
  start.begin(frame, 1);
  frame.depth = 0;
  EXPECT_EQ(start.first()->frame.depth.at<std::uint16_t>(0, 0), 1000);
}

TEST(ModelStart, NothingIsWeighedBeforeTheModelBegins) {
  ModelStart start;
  start.rival(frameAt(0), 1);
  EXPECT_FALSE(start.rival(frameAt(1), 1));
}

}  // namespace test_model_start
}  // namespace rosefusion::testing
