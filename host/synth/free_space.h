// Where in a scene a camera may be.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "host/synth/random.h"
#include "host/synth/tracer.h"

namespace rosefusion {

inline constexpr double kKeyClearance = 0.35;   ///< of key poses to every surface, metres
inline constexpr double kPathClearance = 0.27;  ///< along the path, a little more than the 0.25 promised

/// The largest connected part of a scene's interior that keeps kKeyClearance from every surface and lies at a
/// height of 0.7 to 1.9 m above the floor, on a grid.
class FreeSpace {
 public:
  /// Throws InputError, naming `source`, when the scene encloses no such space.
  FreeSpace(const Tracer& tracer, int threads, const std::string& source);

  const Tracer& tracer() const { return tracer_; }
  const Eigen::Vector3d& up() const { return tracer_.scene().up; }
  double floorHeight() const { return floor_; }  ///< along up, metres
  double cellSize() const { return cell_; }
  std::size_t size() const { return cells_.size(); }
  const Eigen::Vector3d& cell(std::size_t i) const { return cells_[i]; }
  const Eigen::Vector3d& randomCell(Rng& rng) const {
    return cells_[rng.below(static_cast<int>(cells_.size()))];
  }

  /// Index of the free cell that holds `point`, or -1.
  std::int64_t find(const Eigen::Vector3d& point) const;
  bool contains(const Eigen::Vector3d& point) const { return find(point) >= 0; }
  /// The up to six free cells beside cell i.
  std::vector<std::int64_t> neighbours(std::size_t i) const;

  bool isClear(const Eigen::Vector3d& point, double clearance) const {
    return tracer_.clearance(point, clearance) >= clearance;
  }
  /// Every point of the segment keeps `clearance`.
  bool isSegmentClear(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double clearance) const;

 private:
  bool isInside(const Eigen::Vector3d& point) const;
  std::int64_t gridIndex(const Eigen::Vector3i& c) const;

  const Tracer& tracer_;
  double cell_ = 0.1, floor_ = 0;
  Eigen::Vector3d low_;
  Eigen::Vector3i count_;
  std::vector<std::int64_t> index_;  // per grid cell: index into cells_, or -1
  std::vector<Eigen::Vector3d> cells_;
};

}  // namespace rosefusion
