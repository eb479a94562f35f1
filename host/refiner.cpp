#include "host/refiner.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "host/shader_types.h"

namespace rosefusion {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// The step that leads from `from` to `to`.
Vector6 difference(const Pose& from, const Pose& to) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(to.linear() * from.linear().transpose()));
  Vector6 out;
  out << to.translation() - from.translation(), turn.angle() * turn.axis();
  return out;
}

/// The quadratic model of the cost around a pose, with what the depth leaves open held by the expected pose.
struct LocalModel {
  Matrix6 hessian = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  Matrix6 hold = Matrix6::Zero();  ///< weight of the expected pose, per direction
  double constraint = 0;

  LocalModel(const RefineSums& sums, double least_constraint) {
    for (int row = 0, entry = shader::kRefineHessian; row < 6; ++row)
      for (int column = row; column < 6; ++column)
        hessian(row, column) = hessian(column, row) = sums[entry++];
    gradient = Eigen::Map<const Vector6>(&sums[shader::kRefineGradient]);
    // Turns are compared with shifts at the mean distance, and all with a plane's own direction.
    const double shifts = hessian.diagonal().head<3>().sum(), turns = hessian.diagonal().tail<3>().sum();
    if (!(shifts > 0 && turns > 0)) return;
    Vector6 scale = Vector6::Constant(1 / std::sqrt(shifts));
    scale.tail<3>().setConstant(1 / std::sqrt(turns));
    const Eigen::SelfAdjointEigenSolver<Matrix6> solver(scale.asDiagonal() * hessian * scale.asDiagonal());
    constraint = std::max(0.0, solver.eigenvalues()[0]);
    const Vector6 missing = (least_constraint - solver.eigenvalues().array()).max(0.0);
    const Vector6 unscale = scale.cwiseInverse();
    hold = unscale.asDiagonal() * solver.eigenvectors() * missing.asDiagonal() *
           solver.eigenvectors().transpose() * unscale.asDiagonal();
  }
};

PoseFit fitOf(const Pose& pose, const RefineSums& sums, double points, double constraint) {
  PoseFit fit;
  fit.world_from_camera = pose;
  fit.constraint = constraint;
  if (sums[shader::kRefineMostCost] > 0) fit.cost = sums[shader::kRefineCost] / sums[shader::kRefineMostCost];
  if (points > 0) {
    fit.usable = sums[shader::kRefineUsable] / points;
    fit.close = sums[shader::kRefineClose] / points;
  }
  return fit;
}

/// To (u z, v z, z), pixels.
Eigen::Matrix4d imageFromCamera(const Intrinsics& k) {
  Eigen::Matrix4d out = Eigen::Matrix4d::Identity();
  out.topLeftCorner<3, 3>() << k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1;
  return out;
}

/// One start's descent.
struct Descent {
  Pose pose;
  RefineSums sums;
  LocalModel model;
  double damping = 1e-3;
  bool finished = false;
};

}  // namespace

Pose moved(const Pose& pose, const Vector6& step) {
  Pose out = Pose::Identity();
  const double angle = step.tail<3>().norm();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  if (angle > 0) turn = Eigen::AngleAxisd(angle, step.tail<3>() / angle);
  out.linear() = (turn * Eigen::Quaterniond(pose.linear())).normalized().toRotationMatrix();
  out.translation() = pose.translation() + step.head<3>();
  return out;
}

Refiner::Refiner(Device& device, const Settings& settings, const Intrinsics& intrinsics)
    : settings_(settings.refine),
      weights_{static_cast<float>(settings.refine.huber), toShader(settings.depth)},
      image_size_(intrinsics.width, intrinsics.height),
      image_from_camera_(imageFromCamera(intrinsics)),
      recorder_(device),
      select_(device, toShader(intrinsics)),
      refine_(device) {}

void Refiner::look(const PreprocessPass& frame, int stride, const std::optional<Pose>& last) {
  last_ = last;
  select_.record(recorder_, frame, {stride, stride / 2, stride / 2}, nullptr);
  recorder_.submit();
}

std::uint64_t Refiner::takePointsRead() {
  return std::exchange(points_read_, 0);
}

std::vector<RefineSums> Refiner::evaluate(const Volume& volume, std::span<const Pose> poses) {
  std::vector<shader::RefineCandidate> candidates;
  for (const Pose& pose : poses) {
    const Pose last_from_camera = last_ ? last_->inverse() * pose : Pose::Identity();
    candidates.push_back(
        {toShader(pose), toShader(Eigen::Matrix4d(image_from_camera_ * last_from_camera.matrix()))});
  }
  refine_.record(recorder_, volume, select_, candidates, image_size_, weights_);
  recorder_.submit();
  points_read_ += std::uint64_t(poses.size()) * select_.selected();
  return refine_.sums();
}

std::vector<PoseFit> Refiner::refine(const Volume& volume, std::span<const Pose> starts, int iterations,
                                     const Pose& expected) {
  const std::vector<RefineSums> first = evaluate(volume, starts);
  std::vector<Descent> descents;
  for (std::size_t i = 0; i < starts.size(); ++i)
    descents.push_back({starts[i], first[i], LocalModel(first[i], settings_.least_constraint)});
  for (int iteration = 0; iteration < iterations; ++iteration) {
    std::vector<Pose> trials;
    std::vector<Vector6> steps;
    std::vector<Descent*> owners;
    for (Descent& d : descents) {
      if (d.finished) continue;
      Matrix6 h = d.model.hessian + d.model.hold;
      h.diagonal() += d.damping * h.diagonal() + Vector6::Constant(1e-9);
      const Vector6 step = h.ldlt().solve(d.model.hold * difference(d.pose, expected) - d.model.gradient);
      d.finished = !step.allFinite();
      if (d.finished) continue;
      trials.push_back(moved(d.pose, step));
      steps.push_back(step);
      owners.push_back(&d);
    }
    if (trials.empty()) break;
    const std::vector<RefineSums> sums = evaluate(volume, trials);
    for (std::size_t k = 0; k < trials.size(); ++k) {
      Descent& d = *owners[k];
      // The hold is in units of the normal equations' weights, the cost in its own.
      const double shifts = d.model.hessian.diagonal().head<3>().sum();
      const double unit = shifts > 0 ? d.sums[shader::kRefineCostWeight] / shifts : 0;
      const auto objective = [&](const Pose& pose, const RefineSums& at) {
        const Vector6 off = difference(pose, expected);
        return at[shader::kRefineCost] + 0.5 * unit * off.dot(d.model.hold * off);
      };
      if (objective(trials[k], sums[k]) < objective(d.pose, d.sums)) {
        d.pose = trials[k];
        d.sums = sums[k];
        d.model = LocalModel(sums[k], settings_.least_constraint);
        d.damping = std::max(d.damping * 0.1, 1e-6);
      } else {
        d.damping = std::max(d.damping * 10, 1e-2);
      }
      d.finished = steps[k].cwiseAbs().maxCoeff() < settings_.minimum_move || d.damping > 1e3;
    }
  }
  std::vector<PoseFit> fits;
  for (const Descent& d : descents)
    fits.push_back(fitOf(d.pose, d.sums, select_.selected(), d.model.constraint));
  return fits;
}

}  // namespace rosefusion
