// Small holes of depth images, on images made by hand.
#include "host/slam/mapping/depth_holes.h"

#include <gtest/gtest.h>

namespace rosefusion::testing {
namespace test_depth_holes {

constexpr int kSide = 32;

/// A slanted surface that falls off by `slope` a column.
cv::Mat surface(int slope = 3) {
  cv::Mat depth(kSide, kSide, CV_16UC1);
  for (int v = 0; v < kSide; ++v)
    for (int u = 0; u < kSide; ++u)
      depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(1000 + slope * u);
  return depth;
}

TEST(DepthHoles, AGridOfHolesIsFilledByTheSurfaceAround) {
  const cv::Mat whole = surface();
  cv::Mat holed = whole.clone();
  for (int v = 0; v < kSide; ++v)
    for (int u = 0; u < kSide; ++u)
      if ((u / 2 + v) % 2 == 0) holed.at<std::uint16_t>(v, u) = u % 2 ? 0 : 65535;
  const cv::Mat filled = withSmallHolesFilled(holed);
  for (int v = 2; v + 2 < kSide; ++v)
    for (int u = 2; u + 2 < kSide; ++u)
      EXPECT_NEAR(filled.at<std::uint16_t>(v, u), whole.at<std::uint16_t>(v, u), 1) << u << " " << v;
}

TEST(DepthHoles, WhatHasDepthStays) {
  const cv::Mat whole = surface();
  EXPECT_EQ(cv::countNonZero(withSmallHolesFilled(whole) != whole), 0);
}

TEST(DepthHoles, NothingIsFilledBetweenSurfaces) {
  cv::Mat edge = surface(0);
  edge.colRange(0, kSide / 2).setTo(500);
  edge.col(kSide / 2).setTo(0);
  edge.row(0).setTo(0);
  EXPECT_EQ(cv::countNonZero(withSmallHolesFilled(edge) != edge), 0);
}

TEST(DepthHoles, LargeHolesStay) {
  cv::Mat depth = surface();
  depth(cv::Rect(8, 8, 12, 12)).setTo(0);
  const cv::Mat filled = withSmallHolesFilled(depth);
  EXPECT_EQ(cv::countNonZero(filled(cv::Rect(10, 10, 8, 8))), 0);
}

}  // namespace test_depth_holes
}  // namespace rosefusion::testing
