// Time of flight (Kinect v2, Azure Kinect, L515): four phase images of modulated light, each with its own
// shot noise and taken at its own moment, averaged over each pixel's footprint. A pixel that sees two
// surfaces reads neither.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <vector>

#include "host/synth/cast_image.h"
#include "host/synth/depth_simulation.h"
#include "host/synth/renderer.h"

namespace rosefusion {
namespace {

constexpr double kSpeedOfLight = 299792458;
constexpr double kContrast = 0.8;             // of the demodulation
constexpr double kDaylight = 150;             // electrons a phase, of everything else that shines
constexpr double kPhaseReadNoise = 25;        // electrons
constexpr double kLeastAmplitude = 6;         // times its own noise; weaker is invalid
constexpr double kCoarseShare = 1.0 / 8;      // the slow modulation that tells the periods apart
constexpr double kLargestDisagreement = 0.2;  // of a period, between both modulations
constexpr double kWiggle = 0.0015;            // metres: the light is no pure sine
constexpr double kEdgeStep = 0.02;  // of the depth, between neighbours: the footprint is looked at closely
constexpr double kLampReach = 30;

/// Where in a pixel its four rays go: no two of them in one column or row.
const Eigen::Vector2d kInPixel[] = {{-0.125, -0.375}, {0.375, -0.125}, {-0.375, 0.125}, {0.125, 0.375}};

/// One ray's: how far, radially, and how much light comes back.
struct Return {
  float range = 0, light = 0;
};

Return returnOf(const Scene& scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                const Tracer::Hit& hit) {
  if (hit.triangle == Tracer::kNone) return {};
  const Eigen::Vector3f rgb = surfaceColour(scene, hit, origin + hit.distance * direction);
  const double length = direction.norm(), range = hit.distance * length;
  const double facing = std::max(0.0, -hit.normal.dot(direction) / length);
  // The lamp fades towards the corners of its field.
  const double lamp = 1 / (length * length);
  return {static_cast<float>(range), static_cast<float>((0.4 * rgb.x() + 0.35 * rgb.y() + 0.25 * rgb.z()) *
                                                        facing * lamp / (range * range))};
}

/// All rays' returns at one moment (or row by row): one a pixel, or four at edges.
class Exposure {
 public:
  Exposure(const Tracer& tracer, const Intrinsics& k, const std::function<Pose(int)>& pose_of_row)
      : k_(k), centre_(std::size_t(k.width) * k.height) {
    for (int v = 0; v < k.height; ++v) {
      const Pose pose = pose_of_row(v);
      const Eigen::Vector3d origin = pose.translation();
      castRows(tracer, k, pose, kLampReach, v, v + 1,
               [&](int, int u, const Tracer::Hit& hit, const Eigen::Vector3d& d) {
                 centre_[index(u, v)] = returnOf(tracer.scene(), origin, d, hit);
               });
    }
    for (int v = 0; v < k.height; ++v) {
      const Pose pose = pose_of_row(v);
      for (int u = 0; u < k.width; ++u) {
        if (!isEdge(u, v)) continue;
        Eigen::Matrix<double, 3, 4> directions;
        for (int i = 0; i < 4; ++i)
          directions.col(i) = pose.linear() * k.unproject(u + kInPixel[i].x(), v + kInPixel[i].y(), 1);
        Tracer::Hit hits[4];
        tracer.cast4(pose.translation(), directions, kLampReach, hits);
        footprints_.push_back({index(u, v), {}});
        for (int i = 0; i < 4; ++i)
          footprints_.back().second[i] =
              returnOf(tracer.scene(), pose.translation(), directions.col(i), hits[i]);
      }
    }
  }

  /// Calls add(pixel, return, share of the footprint) for every ray.
  template <typename Add>
  void forEach(const Add& add) const {
    std::size_t next = 0;
    for (std::size_t i = 0; i < centre_.size(); ++i)
      if (next < footprints_.size() && footprints_[next].first == i) {
        for (const Return& r : footprints_[next].second) add(i, r, 0.25);
        ++next;
      } else {
        add(i, centre_[i], 1.0);
      }
  }

 private:
  std::size_t index(int u, int v) const { return std::size_t(v) * k_.width + u; }
  bool isEdge(int u, int v) const {
    const float here = centre_[index(u, v)].range;
    const auto differs = [&](int x, int y) {
      return x >= 0 && y >= 0 && x < k_.width && y < k_.height &&
             std::abs(centre_[index(x, y)].range - here) > kEdgeStep * std::max(here, 0.1f);
    };
    return differs(u - 1, v) || differs(u + 1, v) || differs(u, v - 1) || differs(u, v + 1);
  }

  const Intrinsics& k_;
  std::vector<Return> centre_;
  std::vector<std::pair<std::size_t, std::array<Return, 4>>> footprints_;
};

bool isWithin(FieldOfView field, const Intrinsics& k, int u, int v) {
  const double x = std::abs(u - k.cx) / (k.width / 2.0), y = std::abs(v - k.cy) / (k.height / 2.0);
  switch (field) {
    case FieldOfView::Hexagon:
      return x + 0.5 * y <= 1.13;
    case FieldOfView::Circle:
      return x * x + y * y <= 1;
    case FieldOfView::Whole:
      break;
  }
  return true;
}

}  // namespace

cv::Mat measureTimeOfFlight(const Sensor& sensor, const Tracer& tracer, const PoseAt& pose_at, Rng& rng) {
  const Intrinsics& k = sensor.depth;
  const std::size_t pixels = std::size_t(k.width) * k.height;
  const double fine = 4 * std::numbers::pi * sensor.modulation_hz / kSpeedOfLight,
               coarse = fine * kCoarseShare;      // radians a metre
  std::array<std::vector<double>, 4> fast, slow;  // electrons
  const auto collect = [&](const Exposure& exposure, int phase) {
    fast[phase].assign(pixels, kDaylight);
    slow[phase].assign(pixels, kDaylight);
    exposure.forEach([&](std::size_t i, const Return& r, double share) {
      const double light = sensor.signal * share * r.light, shift = phase * std::numbers::pi / 2;
      const double wiggle = kWiggle * std::sin(4 * fine * r.range);
      fast[phase][i] += light * (1 + kContrast * std::cos(fine * (r.range + wiggle) + shift));
      slow[phase][i] += light * (1 + kContrast * std::cos(coarse * r.range + shift));
    });
  };
  if (sensor.row_by_row) {
    const Exposure all(tracer, k,
                       [&](int v) { return pose_at(sensor.exposure * (double(v) / (k.height - 1) - 0.5)); });
    for (int phase = 0; phase < 4; ++phase) collect(all, phase);
  } else {
    for (int phase = 0; phase < 4; ++phase) {
      const Pose pose = pose_at(sensor.exposure * (phase / 3.0 - 0.5));
      collect(Exposure(tracer, k, [&](int) { return pose; }), phase);
    }
  }

  cv::Mat depth(k.height, k.width, CV_32FC1, cv::Scalar(0));
  const double period = 2 * std::numbers::pi / fine;
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) {
      const std::size_t i = std::size_t(v) * k.width + u;
      double f[4], s[4], electrons = 0;
      for (int phase = 0; phase < 4; ++phase) {
        const double variance = kPhaseReadNoise * kPhaseReadNoise;
        f[phase] = fast[phase][i] + std::sqrt(fast[phase][i] + variance) * rng.normal();
        s[phase] = slow[phase][i] + std::sqrt(slow[phase][i] + variance) * rng.normal();
        electrons += fast[phase][i] / 4 + variance / 4;
      }
      const double amplitude = std::hypot(f[0] - f[2], f[3] - f[1]) / 2;
      if (amplitude < kLeastAmplitude * std::sqrt(electrons / 2) || !isWithin(sensor.field, k, u, v))
        continue;
      const auto phaseOf = [](const double a[4]) {
        const double angle = std::atan2(a[3] - a[1], a[0] - a[2]);
        return angle < 0 ? angle + 2 * std::numbers::pi : angle;
      };
      const double within = phaseOf(f) / fine, about = phaseOf(s) / coarse;
      const double periods = std::round((about - within) / period);
      if (std::abs(about - within - periods * period) > kLargestDisagreement * period) continue;
      const double range = within + periods * period;
      if (range > 0) depth.at<float>(v, u) = static_cast<float>(range / k.unproject(u, v, 1).norm());
    }
  return depth;
}

}  // namespace rosefusion
