#include "host/slam/mapping/depth_image.h"

#include <opencv2/core.hpp>

#include "host/slam/mapping/depth_holes.h"

namespace rosefusion {

cv::Mat depthInMetres(const cv::Mat& depth, const DepthSettings& settings, double depth_units_per_metre) {
  cv::Mat metres;
  (settings.footprint ? withSmallHolesFilled(depth) : depth)
      .convertTo(metres, CV_32F, 1 / depth_units_per_metre);
  metres.setTo(0, (metres < settings.min) | (metres > settings.max));
  return metres;
}

}  // namespace rosefusion
