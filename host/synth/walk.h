// A random walk of spline keys that never turns sharply and never comes near a surface.
#pragma once
#include <functional>
#include <map>
#include <tuple>

#include "host/synth/arc_spline.h"
#include "host/synth/free_space.h"

namespace rosefusion {

class Walk {
 public:
  Walk(const FreeSpace& space, Rng& rng) : space_(space), rng_(rng) {}

  /// Sets three keys close together, somewhere in the free space; false where there is no room for them.
  bool start();
  /// Adds the best of many random keys; `attraction` (optional, about 0 to 2) says how good a place is. False
  /// when none of them leads on without a sharp turn or a touch.
  bool extend(const std::function<double(const Eigen::Vector3d&)>& attraction = {});
  /// Takes back up to `count` keys, never the first three.
  void backtrack(int count);

  const PositionSpline& spline() const { return spline_; }
  PositionSpline take() { return std::move(spline_); }

 private:
  using Cell = std::tuple<int, int, int>;
  static Cell cellOf(const Eigen::Vector3d& point);
  bool isPieceClear(const Eigen::Vector3d& next) const;

  const FreeSpace& space_;
  Rng& rng_;
  PositionSpline spline_;
  std::map<Cell, int> visits_;
};

}  // namespace rosefusion
