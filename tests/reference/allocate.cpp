#include "tests/reference/allocate.h"

#include <algorithm>
#include <cmath>

namespace rosefusion::reference {
namespace {

// Metres: a single-precision position some metres from the origin, after a transform (2^-23 * 4 m * a few
// operations).
constexpr double kSegmentError = 5e-6;

Block blockOf(const Eigen::Vector3d& p, double side) {
  return {int(std::floor(p.x() / side)), int(std::floor(p.y() / side)), int(std::floor(p.z() / side))};
}

std::string text(const Block& b) {
  return "block (" + std::to_string(b[0]) + ", " + std::to_string(b[1]) + ", " + std::to_string(b[2]) + ")";
}

}  // namespace

void BandBlocks::add(const PointImage& image, const Intrinsics& camera, const Pose& world_from_camera) {
  for (int v = 0; v < camera.height; v += options_.pixel_stride)
    for (int u = 0; u < camera.width; u += options_.pixel_stride) {
      const std::size_t pixel = std::size_t(v) * camera.width + u;
      if (image.depth[pixel] <= 0) continue;
      const Eigen::Vector3d& p = image.points[pixel];
      const Eigen::Vector3d reach = p.normalized() * options_.half_length;
      segments_.push_back({world_from_camera * (p - reach), world_from_camera * (p + reach)});
      addRequired(segments_.back());
    }
}

bool BandBlocks::clearlyInside(const Eigen::Vector3d& point, const Block& block) const {
  for (int axis = 0; axis < 3; ++axis) {
    const double within = point[axis] - block[axis] * side_;
    if (within < kSegmentError || within > side_ - kSegmentError) return false;
  }
  return true;
}

void BandBlocks::addRequired(const Segment& segment) {
  // Cut the segment at all block faces; each piece lies in one block.
  const Eigen::Vector3d along = segment.to - segment.from;
  std::vector<double> cuts = {0, 1};
  for (int axis = 0; axis < 3; ++axis) {
    const double a = segment.from[axis] / side_, b = segment.to[axis] / side_;
    for (double face = std::ceil(std::min(a, b)); face < std::max(a, b); ++face)
      cuts.push_back((face - a) / (b - a));
  }
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double length = (cuts[i + 1] - cuts[i]) * along.norm();
    if (length > side_ / 4 + 4 * kSegmentError)
      required_.insert(blockOf(segment.from + along * (cuts[i] + cuts[i + 1]) / 2, side_));
  }
  for (const Eigen::Vector3d& end : {segment.from, segment.to})
    if (clearlyInside(end, blockOf(end, side_))) required_.insert(blockOf(end, side_));
}

bool BandBlocks::mayTouch(const Block& block) const {
  return std::any_of(segments_.begin(), segments_.end(), [&](const Segment& segment) {
    double enter = 0, leave = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = block[axis] * side_ - kSegmentError,
                   high = (block[axis] + 1) * side_ + kSegmentError;
      const double from = segment.from[axis], step = segment.to[axis] - from;
      if (step == 0) {
        if (from < low || from > high) return false;
        continue;
      }
      enter = std::max(enter, std::min((low - from) / step, (high - from) / step));
      leave = std::min(leave, std::max((low - from) / step, (high - from) / step));
    }
    return enter <= leave;
  });
}

Comparison compare(const BandBlocks& expected, std::span<const Block> allocated) {
  Comparison result;
  const std::set<Block> present(allocated.begin(), allocated.end());
  for (const Block& block : expected.required())
    result.add(present.count(block) ? 0 : INFINITY, text(block) + " is missing");
  for (const Block& block : present)
    if (!expected.required().count(block))
      result.add(expected.mayTouch(block) ? 0 : INFINITY, text(block) + " touches no band");
  if (present.size() != allocated.size()) result.add(INFINITY, "a block is listed twice");
  return result;
}

}  // namespace rosefusion::reference
