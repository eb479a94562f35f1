// Depth images in metres.
#include "host/slam/mapping/depth_image.h"

#include <gtest/gtest.h>

namespace rosefusion::testing {
namespace test_depth_image {

cv::Mat depths(int width = 8) {
  return cv::Mat(8, width, CV_16UC1, cv::Scalar(10000));
}

TEST(DepthImage, WhatIsOutOfRangeIsNone) {
  DepthSettings settings;
  settings.min = 0.5;
  settings.max = 4;
  cv::Mat image = depths();
  image.at<std::uint16_t>(0, 0) = 0;
  image.at<std::uint16_t>(0, 1) = 65535;
  image.at<std::uint16_t>(0, 2) = 2499;
  image.at<std::uint16_t>(0, 3) = 20001;
  const cv::Mat metres = depthInMetres(image, settings, 5000);
  ASSERT_EQ(metres.type(), CV_32FC1);
  for (int u = 0; u < 4; ++u) EXPECT_EQ(metres.at<float>(0, u), 0) << u;
  EXPECT_FLOAT_EQ(metres.at<float>(0, 4), 2);
}

TEST(DepthImage, SmallHolesAreFilledWithFootprintsOnly) {
  DepthSettings settings;
  cv::Mat image = depths();
  image.at<std::uint16_t>(4, 4) = 0;
  EXPECT_EQ(depthInMetres(image, settings, 5000).at<float>(4, 4), 0);
  settings.footprint = true;
  EXPECT_FLOAT_EQ(depthInMetres(image, settings, 5000).at<float>(4, 4), 2);
  EXPECT_EQ(image.at<std::uint16_t>(4, 4), 0) << "the image itself stays";
}

}  // namespace test_depth_image
}  // namespace rosefusion::testing
