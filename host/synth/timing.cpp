#include "host/synth/timing.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rosefusion {
namespace {

constexpr double kStep = 1.0 / 480;     // seconds
constexpr double kKnotInterval = 0.45;  // seconds between independent random speeds: a hand's pace
constexpr double kHeadroom = 0.985;     // of the highest speed, so that sampling never exceeds it

/// Uniform cubic B-spline of random knots, stretched to [0, 1]; twice differentiable.
std::vector<double> smoothNoise(int count, double duration, Rng& rng) {
  const double interval = std::min(kKnotInterval, duration / 4);
  std::vector<double> knots(static_cast<std::size_t>(duration / interval) + 5);
  for (double& knot : knots) knot = rng.uniform();
  std::vector<double> noise(count);
  for (int i = 0; i < count; ++i) {
    const double position = i * kStep / interval;
    const auto k = std::min(static_cast<std::size_t>(position), knots.size() - 4);
    const double u = position - static_cast<double>(k), v = 1 - u;
    noise[i] = (v * v * v * knots[k] + (3 * u * u * u - 6 * u * u + 4) * knots[k + 1] +
                (-3 * u * u * u + 3 * u * u + 3 * u + 1) * knots[k + 2] + u * u * u * knots[k + 3]) /
               6;
  }
  const auto [low, high] = std::minmax_element(noise.begin(), noise.end());
  const double base = *low, range = std::max(*high - *low, 1e-9);
  for (double& value : noise) value = (value - base) / range;
  return noise;
}

/// Bends [0, 1] onto itself: many slow moments for bend > 0, many fast ones for bend < 0, always smoothly.
double bent(double value, double bend) {
  return bend >= 0 ? std::pow(value, 1 + bend) : 1 - std::pow(1 - value, 1 - bend);
}

}  // namespace

SpeedProfile::SpeedProfile(const SpeedRange& range, double duration, double ramp, Rng& rng) : step_(kStep) {
  const int count = std::max(2, static_cast<int>(std::ceil(duration / kStep)) + 1);
  const std::vector<double> noise = smoothNoise(count, duration, rng);
  const double high = std::max(range.low, range.high * kHeadroom);
  const auto speedAt = [&](int i, double bend) {
    const double x = ramp > 0 ? std::min(1.0, i * kStep / ramp) : 1;
    const double rise = x * x * x * (10 + x * (6 * x - 15));
    return rise * (range.low + (high - range.low) * bent(noise[i], bend));
  };
  double lowest = -30, highest = 30;  // the mean falls as the bend grows
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double bend = (lowest + highest) / 2;
    double sum = 0;
    for (int i = 0; i < count; ++i) sum += speedAt(i, bend);
    (sum / count > range.mean ? lowest : highest) = bend;
  }
  travelled_.assign(1, 0);
  for (int i = 1; i < count; ++i)
    travelled_.push_back(travelled_.back() + kStep * (speedAt(i - 1, lowest) + speedAt(i, lowest)) / 2);
}

double SpeedProfile::travelled(double time) const {
  const double position = std::clamp(time / step_, 0.0, static_cast<double>(travelled_.size() - 1));
  const auto node = std::min(static_cast<std::size_t>(position), travelled_.size() - 2);
  const double fraction = position - static_cast<double>(node);
  return travelled_[node] + fraction * (travelled_[node + 1] - travelled_[node]);
}

double SpeedProfile::timeAt(double length) const {
  const auto after = std::lower_bound(travelled_.begin(), travelled_.end(), length);
  return step_ * static_cast<double>(std::min<std::ptrdiff_t>(
                     after - travelled_.begin(), static_cast<std::ptrdiff_t>(travelled_.size()) - 1));
}

}  // namespace rosefusion
