// Poses that could not be known when they were told, corrected once the camera is held again.
#pragma once
#include <map>

#include "host/core/trajectory.h"

namespace rosefusion {

/// Where depth leaves a direction open, past motion holds a pose there, and it may slide. Once poses that are
/// held come before and after such a stretch, its poses move along their open directions to where a smooth
/// motion between the two likeliest was, each as free as its covariance says: a Gaussian process with white
/// noise on the acceleration (Barfoot, Tong and Sarkka 2014) of the size that the recording's own motion
/// shows. One thread.
class OpenStretches {
 public:
  using Covariance = Eigen::Matrix<double, 6, 6>;
  /// The directions of moved()'s steps in which a pose is free, one per column, and their information.
  struct Freedom {
    Eigen::Matrix<double, 6, Eigen::Dynamic> directions;
    Eigen::VectorXd information;
  };
  using Open = std::map<std::size_t, Freedom>;  ///< by the pose's number in the trajectory

  /// A direction is open where its deviation is more than this, metres and radians.
  explicit OpenStretches(double held_deviation) : held_deviation_(held_deviation) {}

  /// The trajectory's last pose has this covariance; zero is held. True when a stretch before it was
  /// corrected: two held poses must follow it, for their velocity counts as much as their place.
  bool add(Trajectory& trajectory, const Covariance& covariance);
  /// A pose was inserted into the trajectory with this number.
  void renumber(std::size_t inserted);
  void clear() { open_.clear(); }

 private:
  double held_deviation_;
  Open open_;
};

/// Metres and radians per second squared, per axis: how much the motion's velocity changes, from the middle
/// of what the latest poses that are not in `open` tell. Zero where they are too few.
struct MotionChange {
  double shift = 0, turn = 0;
};
MotionChange motionChange(const Trajectory& trajectory, const OpenStretches::Open& open);

}  // namespace rosefusion
