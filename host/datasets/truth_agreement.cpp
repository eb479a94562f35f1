#include "host/datasets/truth_agreement.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "host/core/number_text.h"

namespace rosefusion {
namespace {

constexpr std::size_t kPairs = 6;                     // spread over the sequence
constexpr std::size_t kFurthest = 60;                 // frames between the two of a pair
constexpr double kLeastShift = 0.05;                  // metres; less tells nothing about the scale
constexpr double kMostShift = 0.6, kMostTurn = 0.35;  // more, and they see different things
constexpr double kTolerance = 0.02;  // of the depth: ten times a sensor's noise, a fifth of a usual shift
constexpr double kAgrees = 0.6;      // of the points; the others are hidden from one of the two, or moved
constexpr double kPlainly = 0.2;     // by which another reading must be better
constexpr std::size_t kFewestPoints = 100;

struct SeenTwice {
  Frame from, to;
  Pose from_pose, to_pose;  // world_from_camera, as the file is read
};

/// Another way to read what the files say.
struct Reading {
  std::string reading, remedy;
  double units_per_metre;
  std::function<Pose(const Pose&)> pose;
};

/// The four numbers of a quaternion that was read as x y z w, but written w x y z.
Pose scalarFirst(const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  Pose out = pose;
  out.linear() = Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix();
  return out;
}

/// Of a camera that looks along -z with y up, as in computer graphics.
Pose graphicsAxes(const Pose& pose) {
  Pose out = pose;
  out.linear() *= Eigen::DiagonalMatrix<double, 3>(1, -1, -1);
  return out;
}

std::vector<Reading> otherReadings(double units) {
  const auto same = [](const Pose& p) { return p; };
  std::vector<Reading> readings{
      {"the truth's quaternions are written w first", "write them as 'qx qy qz qw'", units, scalarFirst},
      {"the truth's poses lead from the world to the camera", "invert them: the format wants camera to world",
       units, [](const Pose& p) { return p.inverse(); }},
      {"the truth's camera looks along -z with y up",
       "turn its poses by half a turn about x: the format wants x right, "
       "y down, z forward",
       units, graphicsAxes}};
  for (const double other : {1000.0, 5000.0, 6553.5, 10000.0, 4000.0})
    if (std::abs(other / units - 1) > 0.05)
      readings.push_back({printed("the depth scale is %g units per metre instead of %g", other, units),
                          printed("give --depth-units-per-metre %g, or set it in a sequence.yaml", other),
                          other, same});
  return readings;
}

std::vector<SeenTwice> pairsOf(Sequence& sequence) {
  std::vector<SeenTwice> pairs;
  const SequenceInfo& info = sequence.info();
  const double gap = 0.1 / info.seconds_per_stamp;
  for (std::size_t n = 0; n < kPairs; ++n) {
    const std::size_t first = n * sequence.size() / kPairs;
    SeenTwice pair;
    std::optional<std::size_t> second;  // the one that the camera has moved furthest to
    if (!interpolate(info.truth, sequence.timestamp(first), gap, pair.from_pose)) continue;
    for (std::size_t i = first + 1; i < std::min(sequence.size(), first + kFurthest); ++i) {
      Pose pose;
      if (!interpolate(info.truth, sequence.timestamp(i), gap, pose)) continue;
      const Pose motion = pair.from_pose.inverse() * pose;
      const double shift = motion.translation().norm();
      if (shift > kMostShift || rotationAngle(motion) > kMostTurn) break;
      if (shift < kLeastShift) continue;
      second = i;
      pair.to_pose = pose;
    }
    std::string ignored;
    if (second && sequence.read(first, pair.from, ignored) && sequence.read(*second, pair.to, ignored))
      pairs.push_back(pair);
  }
  return pairs;
}

std::optional<double> agreementOf(const std::vector<SeenTwice>& pairs, const SequenceInfo& info,
                                  const Reading& as) {
  std::vector<double> shares;
  for (const SeenTwice& pair : pairs)
    if (const auto share = depthAgreement(pair.from.depth, pair.to.depth, info.intrinsics, as.units_per_metre,
                                          as.pose(pair.to_pose).inverse() * as.pose(pair.from_pose)))
      shares.push_back(*share);
  if (shares.empty()) return std::nullopt;
  std::nth_element(shares.begin(), shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2),
                   shares.end());
  return shares[shares.size() / 2];
}

}  // namespace

std::optional<double> depthAgreement(const cv::Mat& from, const cv::Mat& to, const Intrinsics& k,
                                     double units_per_metre, const Pose& to_from_from) {
  const int step = std::max(1, std::min(k.width, k.height) / 48);
  std::size_t points = 0, near = 0;
  for (int v = step / 2; v < k.height; v += step)
    for (int u = step / 2; u < k.width; u += step) {
      const std::uint16_t value = from.at<std::uint16_t>(v, u);
      if (value == 0 || value == 65535) continue;
      const Eigen::Vector3d p = to_from_from * k.unproject(u, v, value / units_per_metre);
      if (p.z() <= 0) continue;
      const Eigen::Vector2d at = k.project(p);
      if (!(at.x() >= 0 && at.y() >= 0 && at.x() < k.width - 1 && at.y() < k.height - 1)) continue;
      const std::uint16_t seen =
          to.at<std::uint16_t>(static_cast<int>(std::lround(at.y())), static_cast<int>(std::lround(at.x())));
      if (seen == 0 || seen == 65535) continue;
      ++points;
      if (std::abs(p.z() - seen / units_per_metre) < kTolerance * p.z()) ++near;
    }
  if (points < kFewestPoints) return std::nullopt;
  return static_cast<double>(near) / static_cast<double>(points);
}

TruthCheck checkTruth(Sequence& sequence) {
  const SequenceInfo& info = sequence.info();
  if (info.truth.size() < 2 || sequence.size() < 2) return {};
  const std::vector<SeenTwice> pairs = pairsOf(sequence);
  const auto as_read =
      agreementOf(pairs, info, {"", "", info.depth_units_per_metre, [](const Pose& p) { return p; }});
  if (!as_read) return {};
  TruthDoubt best{*as_read, 0, "", ""};
  for (const Reading& reading : otherReadings(info.depth_units_per_metre)) {
    const auto share = agreementOf(pairs, info, reading);
    if (share && *share > best.other_agreement) best = {*as_read, *share, reading.reading, reading.remedy};
  }
  if (best.other_agreement < std::max(kAgrees, *as_read + kPlainly))
    return {*as_read >= kAgrees, std::nullopt};
  return {false, best};
}

}  // namespace rosefusion
