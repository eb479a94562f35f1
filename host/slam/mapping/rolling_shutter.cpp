#include "host/slam/mapping/rolling_shutter.h"

#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

namespace rosefusion {
namespace {

/// Takes the homogeneous pixel of a row, times its depth, to that of the middle row's time.
struct RowMotion {
  Eigen::Matrix3f turn;
  Eigen::Vector3f shift;
};

std::vector<RowMotion> rowMotions(const Intrinsics& k, double readout, const Velocity& motion) {
  Eigen::Matrix3d project = Eigen::Matrix3d::Identity();
  project << k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1;
  const Eigen::Matrix3d unproject = project.inverse();
  std::vector<RowMotion> rows;
  for (int v = 0; v < k.height; ++v) {
    const double later = readout * ((v + 0.5) / k.height - 0.5);
    const double angle = later * motion.angular.norm();
    const Eigen::Matrix3d turn =
        angle == 0 ? Eigen::Matrix3d::Identity()
                   : Eigen::AngleAxisd(angle, motion.angular.normalized()).toRotationMatrix();
    rows.push_back(
        {(project * turn * unproject).cast<float>(), (project * motion.linear * later).cast<float>()});
  }
  return rows;
}

/// The smaller of two slopes where they agree: across an edge of a surface there is none.
float minmod(float a, float b) {
  return a * b <= 0 ? 0 : std::abs(a) < std::abs(b) ? a : b;
}

/// A depth image in metres, of which holes are 0.
class Depths {
 public:
  Depths(const cv::Mat& raw, double units_per_metre)
      : raw_(raw), metres_(static_cast<float>(1 / units_per_metre)) {}

  float at(int u, int v) const {
    const std::uint16_t value = raw_.at<std::uint16_t>(v, u);
    return value == 65535 ? 0 : metres_ * value;
  }
  /// What is that far beside a pixel, which has a depth; at most one.
  float beside(int u, int v, float off_u, float off_v) const {
    return at(u, v) + slope(u, v, 1, 0) * off_u + slope(u, v, 0, 1) * off_v;
  }

 private:
  float slope(int u, int v, int du, int dv) const {
    if (u < du || v < dv || u + du >= raw_.cols || v + dv >= raw_.rows) return 0;
    const float before = at(u - du, v - dv), here = at(u, v), after = at(u + du, v + dv);
    return before > 0 && after > 0 ? minmod(here - before, after - here) : 0;
  }

  const cv::Mat& raw_;
  float metres_;
};

}  // namespace

Frame withoutRollingShutter(const Frame& frame, const Intrinsics& k, double depth_units_per_metre,
                            double readout, const Velocity& motion) {
  if (frame.depth.size() != cv::Size(k.width, k.height) || frame.depth.type() != CV_16UC1) return frame;
  const std::vector<RowMotion> rows = rowMotions(k, readout, motion);
  const Depths depths(frame.depth, depth_units_per_metre);
  Frame out = frame;
  out.depth = cv::Mat(frame.depth.size(), frame.depth.type(), cv::Scalar(0));
  const bool coloured = frame.colour.size() == frame.depth.size() && frame.colour.type() == CV_8UC3;
  if (coloured) out.colour = cv::Mat(frame.colour.size(), frame.colour.type(), cv::Scalar(0));
  // What a pixel shows had moved by a smooth function of it: the pixel that is moved onto a target is found
  // by following that back from the target, beginning as far away as the neighbour's was.
  constexpr int kSteps = 3;
  cv::parallel_for_(cv::Range(0, k.height), [&](const cv::Range& range) {
    for (int v = range.start; v < range.end; ++v) {
      int away_u = 0, away_v = 0;
      for (int u = 0; u < k.width; ++u) {
        int from_u = u + away_u, from_v = v + away_v;
        away_u = away_v = 0;
        for (int step = 0; step < kSteps; ++step) {
          if (from_u < 0 || from_v < 0 || from_u >= k.width || from_v >= k.height) break;
          const float known = depths.at(from_u, from_v);
          // A turn moves all depths alike, so that a hole is moved as what is far.
          const float z = known > 0 ? known : 1e6f;
          const RowMotion& row = rows[from_v];
          const Eigen::Vector3f to = row.turn * Eigen::Vector3f(z * from_u, z * from_v, z) + row.shift;
          const float scale = 1 / to.z(), off_u = u - to.x() * scale, off_v = v - to.y() * scale;
          if (!(std::abs(off_u) > 0.5f || std::abs(off_v) > 0.5f) || step + 1 == kSteps) {
            if (known > 0 && std::abs(off_u) < 1 && std::abs(off_v) < 1)
              out.depth.at<std::uint16_t>(v, u) = cv::saturate_cast<std::uint16_t>(
                  depth_units_per_metre * (to.z() + depths.beside(from_u, from_v, off_u, off_v) - z));
            if (coloured) out.colour.at<cv::Vec3b>(v, u) = frame.colour.at<cv::Vec3b>(from_v, from_u);
            away_u = from_u - u;
            away_v = from_v - v;
            break;
          }
          if (std::abs(off_u) >= k.width || std::abs(off_v) >= k.height) break;
          from_u += static_cast<int>(std::lround(off_u));
          from_v += static_cast<int>(std::lround(off_v));
        }
      }
    }
  });
  return out;
}

}  // namespace rosefusion
