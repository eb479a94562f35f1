#include "host/slam/mapping/open_stretches.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace rosefusion {
namespace {

constexpr std::size_t kHeld = 2;               // poses on either side: a place and a velocity
constexpr std::size_t kFewest = 10;            // changes of velocity that a size is read from
constexpr std::size_t kWindow = 300;           // poses looked back on, which bounds the work and what is kept
constexpr int kIterations = 3;                 // turns are nearly linear
constexpr double kDeviationOfMedian = 1.4826;  // of a Gaussian's absolute values

bool haveTimeBetween(const StampedPose& a, const StampedPose& b, const StampedPose& c) {
  return a.timestamp < b.timestamp && b.timestamp < c.timestamp;
}

/// The change of velocity at the middle of three poses that have time between them, per second squared.
Vector6 acceleration(const StampedPose& a, const StampedPose& b, const StampedPose& c) {
  const double before = b.timestamp - a.timestamp, after = c.timestamp - b.timestamp;
  return (difference(b.world_from_camera, c.world_from_camera) / after -
          difference(a.world_from_camera, b.world_from_camera) / before) *
         (2 / (before + after));
}

double deviationOf(std::vector<double>& sizes) {
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return kDeviationOfMedian * *middle;
}

/// Moves the poses from `first` to before `past` along their open directions. False where that has no
/// solution.
bool correct(Trajectory& trajectory, const OpenStretches::Open& open, std::size_t first, std::size_t past,
             const MotionChange& change) {
  Vector6 weight;
  weight << Eigen::Vector3d::Constant(1 / change.shift), Eigen::Vector3d::Constant(1 / change.turn);
  std::vector<const OpenStretches::Freedom*> free;
  std::vector<Eigen::Index> places{0};
  for (std::size_t i = first; i < past; ++i) {
    free.push_back(&open.at(i));
    places.push_back(places.back() + free.back()->information.size());
  }
  const Trajectory told(trajectory.begin() + static_cast<std::ptrdiff_t>(first),
                        trajectory.begin() + static_cast<std::ptrdiff_t>(past));
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(places.back(), places.back());
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(places.back());
    for (std::size_t i = 0; i < free.size(); ++i) {
      const auto& [directions, information] = *free[i];
      const Vector6 off = difference(told[i].world_from_camera, trajectory[first + i].world_from_camera);
      hessian.diagonal().segment(places[i], information.size()) += information;
      gradient.segment(places[i], information.size()) +=
          information.cwiseProduct(directions.transpose() * off);
    }
    // Every three poses in a row of which one is free; acceleration() is linear in each of them.
    for (std::size_t middle = first - 1; middle <= past; ++middle) {
      const StampedPose &a = trajectory[middle - 1], &b = trajectory[middle], &c = trajectory[middle + 1];
      const double before = b.timestamp - a.timestamp, after = c.timestamp - b.timestamp;
      if (!haveTimeBetween(a, b, c)) continue;
      const double scale = 2 / (before + after);
      const double slopes[] = {scale / before, -scale / before - scale / after, scale / after};
      const Vector6 residual = weight.cwiseProduct(acceleration(a, b, c));
      const auto freeOf = [&](std::size_t j) {  // past the last where pose j of the three is held
        const std::size_t pose = middle - 1 + j;
        return pose >= first && pose < past ? pose - first : free.size();
      };
      for (std::size_t j = 0; j < 3; ++j) {
        const std::size_t row = freeOf(j);
        if (row == free.size()) continue;
        const Eigen::MatrixXd moves = slopes[j] * weight.asDiagonal() * free[row]->directions;
        gradient.segment(places[row], moves.cols()) += moves.transpose() * residual;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t column = freeOf(k);
          if (column == free.size()) continue;
          const Eigen::MatrixXd others = slopes[k] * weight.asDiagonal() * free[column]->directions;
          hessian.block(places[row], places[column], moves.cols(), others.cols()) +=
              moves.transpose() * others;
        }
      }
    }
    const Eigen::VectorXd step = hessian.ldlt().solve(-gradient);
    if (!step.allFinite()) return false;
    for (std::size_t i = 0; i < free.size(); ++i) {
      Pose& pose = trajectory[first + i].world_from_camera;
      pose = moved(pose, free[i]->directions * step.segment(places[i], free[i]->information.size()));
    }
  }
  return true;
}

}  // namespace

MotionChange motionChange(const Trajectory& trajectory, const OpenStretches::Open& open) {
  std::vector<double> shifts, turns;
  const std::size_t begin = trajectory.size() > 2 * kWindow ? trajectory.size() - 2 * kWindow : 0;
  for (std::size_t i = begin + 1; i + 1 < trajectory.size(); ++i) {
    const StampedPose &a = trajectory[i - 1], &b = trajectory[i], &c = trajectory[i + 1];
    const auto near = open.lower_bound(i - 1);
    if ((near != open.end() && near->first <= i + 1) || !haveTimeBetween(a, b, c)) continue;
    const Vector6 change = acceleration(a, b, c);
    for (int axis = 0; axis < 3; ++axis) {
      shifts.push_back(std::abs(change[axis]));
      turns.push_back(std::abs(change[axis + 3]));
    }
  }
  if (shifts.size() < 3 * kFewest) return {};
  return {deviationOf(shifts), deviationOf(turns)};
}

void OpenStretches::renumber(std::size_t inserted) {
  Open moved;
  for (auto& [number, freedom] : open_) moved.emplace(number + (number >= inserted), std::move(freedom));
  open_ = std::move(moved);
}

bool OpenStretches::add(Trajectory& trajectory, const Covariance& covariance) {
  const Eigen::SelfAdjointEigenSolver<Covariance> solver(covariance);  // ascending
  const auto open = (solver.eigenvalues().array() > held_deviation_ * held_deviation_).count();
  if (trajectory.size() > 2 * kWindow)
    open_.erase(open_.begin(), open_.lower_bound(trajectory.size() - 2 * kWindow));
  if (open > 0) {
    open_[trajectory.size() - 1] = {solver.eigenvectors().rightCols(open),
                                    solver.eigenvalues().tail(open).cwiseInverse()};
    return false;
  }
  if (open_.empty() || trajectory.size() < kHeld + 1) return false;
  const std::size_t past = trajectory.size() - kHeld;
  if (open_.rbegin()->first != past - 1) return false;
  std::size_t first = past - 1;
  while (first > 0 && open_.contains(first - 1)) --first;
  const MotionChange change = motionChange(trajectory, open_);
  if (first < kHeld || past - first > kWindow || !(change.shift > 0 && change.turn > 0)) return false;
  return correct(trajectory, open_, first, past, change);
}

}  // namespace rosefusion
