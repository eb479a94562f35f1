#include "host/slam/relocalisation/plane_alignment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace rosefusion {
namespace {

const double kFacing = std::cos(0.25);  // of one direction
constexpr double kIndependent = 0.5;    // of two axes: sine of the angle between them
constexpr double kAxisShare = 0.03;     // that an axis needs
constexpr std::size_t kDirections = 6;
constexpr double kBin = 0.05;       // metres, of the histograms of offsets
constexpr std::size_t kShifts = 8;  // tried along an axis
constexpr int kShiftsApart = 3;     // bins
constexpr double kOpenStep = 0.3;   // along an axis that the view leaves open
constexpr std::size_t kTriedPatches = 100;
constexpr double kCell = 0.2;  // a patch of the view meets those of the model about this near
constexpr double kOnePlaceShift = 0.25, kOnePlaceTurn = 0.25;

/// Patches of the model by place, and by the side that they face.
class Patches {
 public:
  explicit Patches(std::span<const SurfacePatch> model) {
    for (const SurfacePatch& patch : model)
      for (int i = 0; i < 8; ++i) {
        const Eigen::Vector3d off(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
        sides_[key(patch.point / kCell + off)] |= side(patch.normal);
      }
  }
  bool meets(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
    const auto found = sides_.find(key(point / kCell));
    return found != sides_.end() && found->second & side(normal);
  }

 private:
  static std::uint64_t key(const Eigen::Vector3d& cell) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k)
      key =
          key << 21 | (static_cast<std::uint64_t>(std::llround(std::floor(cell[k])) + (1 << 20)) & 0x1fffff);
    return key;
  }
  /// Every axis of the world that the normal leans to: two that are a little apart have one in common.
  static std::uint8_t side(const Eigen::Vector3d& normal) {
    std::uint8_t sides = 0;
    for (int k = 0; k < 3; ++k) {
      if (normal[k] > 0.5) sides |= static_cast<std::uint8_t>(1 << k);
      if (normal[k] < -0.5) sides |= static_cast<std::uint8_t>(8 << k);
    }
    return sides;
  }
  std::unordered_map<std::uint64_t, std::uint8_t> sides_;
};

/// Counts of patches that face along an axis or against it, by their offset along it.
class Offsets {
 public:
  Offsets(const Eigen::Vector3d& axis, double first, double last)
      : axis_(axis),
        first_(first),
        bins_{std::vector<float>(size(first, last)), std::vector<float>(size(first, last))} {}
  void add(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
    const double along = normal.dot(axis_);
    if (std::abs(along) < kFacing) return;
    const auto bin = std::lround((point.dot(axis_) - first_) / kBin);
    auto& side = bins_[along < 0];
    if (bin >= 0 && bin < static_cast<long>(side.size())) side[static_cast<std::size_t>(bin)] += 1;
  }
  /// A large wall is to count for more than a small thing, but not by its area.
  void level() {
    for (auto& side : bins_)
      for (float& bin : side) bin = std::sqrt(bin);
  }
  double first() const { return first_; }
  const std::vector<float>& side(int i) const { return bins_[i]; }

 private:
  static std::size_t size(double first, double last) {
    return static_cast<std::size_t>(std::max(0.0, (last - first) / kBin)) + 2;
  }
  Eigen::Vector3d axis_;
  double first_;
  std::vector<float> bins_[2];
};

struct Span {
  double first = 0, last = 0;
};

Span spanAlong(const Eigen::Vector3d& axis, std::span<const SurfacePatch> patches) {
  const auto [first, last] = std::minmax_element(
      patches.begin(), patches.end(),
      [&](const SurfacePatch& a, const SurfacePatch& b) { return axis.dot(a.point) < axis.dot(b.point); });
  return {axis.dot(first->point), axis.dot(last->point)};
}

Offsets offsetsAlong(const Eigen::Vector3d& axis, std::span<const SurfacePatch> patches) {
  const Span span = spanAlong(axis, patches);
  Offsets offsets(axis, span.first, span.last);
  for (const SurfacePatch& patch : patches) offsets.add(patch.point, patch.normal);
  offsets.level();
  return offsets;
}

/// The shifts along an axis, in metres, that bring most of the view's offsets onto the model's.
std::vector<double> bestShifts(const Offsets& view, const Offsets& model) {
  const auto n = static_cast<int>(view.side(0).size()), m = static_cast<int>(model.side(0).size());
  std::vector<std::pair<float, int>> scores;  // by shift in bins
  for (int shift = -n; shift <= m; ++shift) {
    float score = 0;
    for (int s = 0; s < 2; ++s)
      for (int i = std::max(0, -shift); i < std::min(n, m - shift); ++i) {
        const float seen = view.side(s)[static_cast<std::size_t>(i)];
        if (seen == 0) continue;
        const auto& side = model.side(s);
        const auto at = [&](int k) { return k < 0 || k >= m ? 0.f : side[static_cast<std::size_t>(k)]; };
        score += seen * (at(i + shift) + 0.5f * (at(i + shift - 1) + at(i + shift + 1)));
      }
    scores.emplace_back(score, shift);
  }
  std::stable_sort(scores.begin(), scores.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<double> shifts;
  std::vector<int> taken;
  for (const auto& [score, shift] : scores) {
    if (score <= 0 || taken.size() == kShifts) break;
    if (std::any_of(taken.begin(), taken.end(),
                    [&, s = shift](int t) { return std::abs(t - s) < kShiftsApart; }))
      continue;
    taken.push_back(shift);
    shifts.push_back(model.first() - view.first() + shift * kBin);
  }
  return shifts;
}

/// Up to three of these directions that span the space well, not at right angles in general.
std::vector<Eigen::Vector3d> axesAmong(std::span<const SurfaceDirection> directions,
                                       const Eigen::Matrix3d& turn) {
  std::vector<Eigen::Vector3d> axes;
  for (const SurfaceDirection& d : directions) {
    const Eigen::Vector3d axis = turn * d.normal;
    const double apart = axes.empty()       ? 1
                         : axes.size() == 1 ? axes[0].cross(axis).norm()
                         : axes.size() == 2 ? std::abs(axes[0].cross(axes[1]).normalized().dot(axis))
                                            : 0;
    if (apart > kIndependent) axes.push_back(axis);
  }
  return axes;
}

/// Places of the view, turned into the world already, that put its offsets along the axes onto the model's.
std::vector<Eigen::Vector3d> shiftsOnto(std::vector<Eigen::Vector3d> axes, std::span<const SurfacePatch> view,
                                        std::span<const SurfacePatch> model) {
  std::vector<std::vector<double>> shifts;
  for (const Eigen::Vector3d& axis : axes)
    shifts.push_back(bestShifts(offsetsAlong(axis, view), offsetsAlong(axis, model)));
  if (axes.size() == 2) {
    axes.push_back(axes[0].cross(axes[1]).normalized());
    const Span in_view = spanAlong(axes[2], view), in_model = spanAlong(axes[2], model);
    shifts.emplace_back();
    for (double s = in_model.first - in_view.last; s <= in_model.last - in_view.first; s += kOpenStep)
      shifts[2].push_back(s);
  }
  Eigen::Matrix3d rows;
  rows << axes[0].transpose(), axes[1].transpose(), axes[2].transpose();
  const Eigen::Matrix3d from_offsets = rows.inverse();
  std::vector<Eigen::Vector3d> all;
  for (const double a : shifts[0])
    for (const double b : shifts[1])
      for (const double c : shifts[2]) all.push_back(from_offsets * Eigen::Vector3d(a, b, c));
  return all;
}

}  // namespace

std::vector<PoseHypothesis> poseHypotheses(std::span<const SurfacePatch> view,
                                           std::span<const SurfacePatch> model,
                                           std::span<const Eigen::Matrix3d> rotations, std::size_t most) {
  if (view.empty() || model.empty()) return {};
  const Patches patches(model);
  const std::vector<SurfaceDirection> directions =
      dominantDirections(normalsOf(view), kAxisShare, kDirections);
  const std::size_t every = std::max<std::size_t>(1, view.size() / kTriedPatches);
  std::vector<PoseHypothesis> candidates;
  for (const Eigen::Matrix3d& turn : rotations) {
    const std::vector<Eigen::Vector3d> axes = axesAmong(directions, turn);
    if (axes.size() < 2) continue;
    std::vector<SurfacePatch> turned;
    for (const SurfacePatch& patch : view) turned.push_back({turn * patch.point, turn * patch.normal});
    for (const Eigen::Vector3d& shift : shiftsOnto(axes, turned, model)) {
      PoseHypothesis candidate;
      candidate.world_from_camera.linear() = turn;
      candidate.world_from_camera.translation() = shift;
      int tried = 0, met = 0;
      for (std::size_t i = 0; i < turned.size(); i += every, ++tried)
        met += patches.meets(turned[i].point + shift, turned[i].normal);
      candidate.met = static_cast<double>(met) / tried;
      candidates.push_back(candidate);
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const PoseHypothesis& a, const PoseHypothesis& b) { return a.met > b.met; });
  std::vector<PoseHypothesis> kept;
  for (const PoseHypothesis& candidate : candidates) {
    if (kept.size() == most) break;
    if (std::none_of(kept.begin(), kept.end(), [&](const PoseHypothesis& other) {
          return areNear(other.world_from_camera, candidate.world_from_camera, kOnePlaceShift, kOnePlaceTurn);
        }))
      kept.push_back(candidate);
  }
  return kept;
}

}  // namespace rosefusion
