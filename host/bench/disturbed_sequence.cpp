#include "host/bench/disturbed_sequence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/bench/seen_before.h"
#include "host/bench/tracking_suite.h"
#include "host/core/error.h"

namespace rosefusion {
namespace {

constexpr std::size_t kLeastFrames = 90;
constexpr std::array<const char*, 4> kWords = {"none", "cut", "black", "hand"};

/// The image's lower left half becomes a bulging surface 30 to 40 cm away that sways a little.
void coverWithHand(cv::Mat& depth, double units_per_metre, double phase) {
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const double x = static_cast<double>(u) / depth.cols, y = static_cast<double>(v) / depth.rows;
      const double inside = 0.5 + 0.04 * std::sin(phase) + 0.1 * std::sin(9 * y) + 0.2 * (y - 0.5) - x;
      if (inside < 0) continue;
      const double z = 0.4 - 0.1 * std::sqrt(std::min(1.0, 3 * inside)) + 0.01 * std::cos(phase);
      depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(std::lround(z * units_per_metre));
    }
}

}  // namespace

const char* toString(Disturbance disturbance) {
  return kWords[static_cast<std::size_t>(disturbance)];
}

Disturbance disturbanceFrom(const std::string& word) {
  for (std::size_t i = 0; i < kWords.size(); ++i)
    if (word == kWords[i]) return static_cast<Disturbance>(i);
  throw InputError("There is no disturbance '" + word + "'; known are none, cut, black and hand.");
}

DisturbedSequence::DisturbedSequence(Sequence& whole, Disturbance disturbance)
    : whole_(whole), disturbance_(disturbance), first_(whole.size() / 2) {
  if (whole.size() < kLeastFrames)
    throw InputError(whole.info().path.string() + ": has " + std::to_string(whole.size()) +
                     " frames, too few to disturb some of them; give --frames " +
                     std::to_string(kLeastFrames) + " or more.");
  info_ = whole.info();
  count_ = disturbance == Disturbance::None ? 0 : disturbance == Disturbance::Black ? 10 : 30;
  if (disturbance == Disturbance::Cut) info_.frames -= count_;
}

std::size_t DisturbedSequence::indexInWhole(std::size_t index) const {
  return disturbance_ == Disturbance::Cut && index >= first_ ? index + count_ : index;
}

double DisturbedSequence::viewReturns() const {
  constexpr double kEnough = 0.5;
  constexpr std::size_t kEvery = 3;  // of the frames before: neighbours show the same
  constexpr std::size_t kStays = Recovery::kMostFrames;
  SeenBefore seen(info_.intrinsics, info_.depth_units_per_metre);
  Frame frame;
  std::string problem;
  const auto truthAt = [&](std::size_t i) {
    const double stamp = whole_.timestamp(i);
    return std::min_element(info_.truth.begin(), info_.truth.end(),
                            [&](const StampedPose& a, const StampedPose& b) {
                              return std::abs(a.timestamp - stamp) < std::abs(b.timestamp - stamp);
                            })
        ->world_from_camera;
  };
  for (std::size_t i = 0; i < first_; i += kEvery)
    if (whole_.read(i, frame, problem)) seen.add(frame, truthAt(i));
  std::size_t in_turn = 0;
  for (std::size_t i = first_ + count_; i < whole_.size(); ++i) {
    in_turn = whole_.read(i, frame, problem) && seen.share(frame, truthAt(i)) >= kEnough ? in_turn + 1 : 0;
    if (in_turn == kStays) return whole_.timestamp(i + 1 - kStays);
  }
  return std::numeric_limits<double>::infinity();
}

bool DisturbedSequence::read(std::size_t index, Frame& frame, std::string& problem) {
  const std::size_t i = indexInWhole(index);
  if (!whole_.read(i, frame, problem)) return false;
  if (i < first_ || i >= first_ + count_) return true;
  frame.depth = frame.depth.clone();
  if (disturbance_ == Disturbance::Black) frame.depth.setTo(0);
  if (disturbance_ == Disturbance::Hand)
    coverWithHand(frame.depth, info_.depth_units_per_metre, 0.5 * static_cast<double>(i - first_));
  return true;
}

}  // namespace rosefusion
