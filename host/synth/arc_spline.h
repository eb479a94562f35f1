// Smooth (C2) curves through space and through rotations, walked by arc length.
#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

namespace rosefusion {

/// Uniform cubic B-spline at u in [0, 1] of the piece that four consecutive keys define. The curve runs near
/// the keys, not through them, and stays within their convex hull.
inline Eigen::Vector3d blend(const Eigen::Vector3d keys[4], double u) {
  const double v = 1 - u;
  return (v * v * v * keys[0] + (3 * u * u * u - 6 * u * u + 4) * keys[1] +
          (-3 * u * u * u + 3 * u * u + 3 * u + 1) * keys[2] + u * u * u * keys[3]) /
         6;
}

/// The same on rotations (Kim, Kim, Shin: A general construction scheme for unit quaternion curves, SIGGRAPH
/// 1995).
inline Eigen::Quaterniond blend(const Eigen::Quaterniond keys[4], double u) {
  const double weights[] = {(5 + 3 * u - 3 * u * u + u * u * u) / 6,
                            (1 + 3 * u + 3 * u * u - 2 * u * u * u) / 6, u * u * u / 6};
  Eigen::Quaterniond q = keys[0];
  for (int i = 0; i < 3; ++i) {
    Eigen::AngleAxisd step(keys[i].conjugate() * keys[i + 1]);
    step.angle() *= weights[i];
    q = q * step;
  }
  return q.normalized();
}

inline double distanceBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).norm();
}
inline double distanceBetween(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.angularDistance(b);
}

/// A curve that grows by one piece per key after the third. Key: Eigen::Vector3d (metres) or Quaterniond
/// (radians).
template <typename Key>
class ArcSpline {
 public:
  void push(const Key& key) {
    keys_.push_back(key);
    if (keys_.size() < 4) return;
    Key last = blend(&keys_[keys_.size() - 4], 0.0);
    for (int i = 1; i <= kSamples; ++i) {
      const Key now = blend(&keys_[keys_.size() - 4], double(i) / kSamples);
      lengths_.push_back(lengths_.back() + distanceBetween(last, now));
      last = now;
    }
  }
  void pop() {
    if (keys_.size() >= 4) lengths_.resize(lengths_.size() - kSamples);
    keys_.pop_back();
  }
  const std::vector<Key>& keys() const { return keys_; }
  double length() const { return lengths_.back(); }

  /// The point at arc length s, clamped to the curve; needs four keys.
  Key at(double s) const {
    const auto after = std::upper_bound(lengths_.begin(), lengths_.end(), s);
    const std::size_t node = std::clamp<std::size_t>(after - lengths_.begin(), 1, lengths_.size() - 1) - 1;
    const double step = lengths_[node + 1] - lengths_[node];
    const double fraction = step > 0 ? std::clamp((s - lengths_[node]) / step, 0.0, 1.0) : 0;
    return blend(&keys_[node / kSamples], (static_cast<double>(node % kSamples) + fraction) / kSamples);
  }

 private:
  static constexpr int kSamples = 64;  // per piece; the speed is then even to about 1 part in 1000
  std::vector<Key> keys_;
  std::vector<double> lengths_{0};  // at each sample from the curve's start
};

using PositionSpline = ArcSpline<Eigen::Vector3d>;
using RotationSpline = ArcSpline<Eigen::Quaterniond>;

}  // namespace rosefusion
