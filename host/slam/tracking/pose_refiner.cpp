#include "host/slam/tracking/pose_refiner.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "host/slam/shader_types.h"
#include "host/slam/tracking/symmetric.h"

namespace rosefusion {
namespace {

// So many of the pixels that are looked at err as one: noise is alike over patches, and the model errs with
// them (tests/bench/notes/tracking.md#covariance).
constexpr double kAlike = 20;
// Of a pixel from the model, white being 1: the camera's noise, detail finer than a voxel, light that changes
// with the view. Beyond twice of it a residual counts linearly.
constexpr double kLuminanceDeviation = 0.03, kLuminanceHuber = 2 * kLuminanceDeviation;

// A plane leaves three directions open; more need not be asked for what noise makes of them.
constexpr int kOpenBeforeAPlane = 3;
// Of the model's slopes, noise is alike over about a voxel: so far a pose is moved to see whether its cost
// rises (tests/bench/notes/tracking.md#constraints-that-noise-feigns).
constexpr double kProbeVoxels = 1;

constexpr std::size_t kBands = 16;  // of rows, in each of which all are taken for the middle one

constexpr double kLeastDamping = 1e-6, kMostDamping = 1e3;

double nextDamping(double refused) {
  return std::max(refused * 10, 1e-2);
}

/// To (u z, v z, z), pixels.
Eigen::Matrix4d imageFromCamera(const Intrinsics& k) {
  Eigen::Matrix4d out = Eigen::Matrix4d::Identity();
  out.topLeftCorner<3, 3>() << k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1;
  return out;
}

/// The same for an image that holds every point, far from its border.
Eigen::Matrix4d allInItsMiddle(const shader::CameraIntrinsics& camera) {
  Eigen::Matrix4d out = Eigen::Matrix4d::Zero();
  out.col(3) << 0.5e6 * camera.size.x, 0.5e6 * camera.size.y, 1e6, 1;
  return out;
}

/// Robust cost of a point's luminance, on average; that of a misfit where no point reads a colour.
double meanCost(const RefineColourSums& sums) {
  const double points = sums[shader::kRefineColourPoints];
  return points > 0 ? sums[shader::kRefineColourCost] / points : kLuminanceHuber * kLuminanceHuber;
}

}  // namespace

/// The quadratic model of the cost around a pose, with what depth and colour leave open held by the expected
/// pose.
struct PoseRefiner::LocalModel {
  Matrix6 hessian;
  Vector6 gradient;
  Matrix6 hold = Matrix6::Zero();         ///< weight of the expected pose, per direction
  double confirmed = 0;                   ///< smallest eigenvalue, without what is overstated
  Matrix6 information = Matrix6::Zero();  ///< the Hessian without what is overstated
  Vector6 scale =
      Vector6::Zero();   ///< of unknowns without units, in which a plane holds its own direction by 1
  double cost_unit = 0;  ///< of the normal equations' weights, in those of the cost
  /// A step moves the gain by gain_step + gain_slope * step.
  Vector6 gain_slope = Vector6::Zero();
  double gain_step = 0;

  /// `overstated`: of the scaled Hessian, what the cost does not confirm (PoseRefiner::overstatedAt).
  LocalModel(const Evaluation& at, double colour_weight, double least_constraint, const Matrix6& overstated)
      : hessian(symmetric<6>(&at.depth[shader::kRefineHessian])),
        gradient(Eigen::Map<const Vector6>(&at.depth[shader::kRefineGradient])) {
    // Turns are compared with shifts at the mean distance, and all with a plane's own direction.
    const double shifts = hessian.diagonal().head<3>().sum(), turns = hessian.diagonal().tail<3>().sum();
    if (at.colour) add(*at.colour, colour_weight);
    if (!(shifts > 0 && turns > 0)) return;
    cost_unit = at.depth[shader::kRefineCostWeight] / shifts;
    scale << Eigen::Vector3d::Constant(1 / std::sqrt(shifts)),
        Eigen::Vector3d::Constant(1 / std::sqrt(turns));
    const Vector6 unscale = scale.cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<Matrix6> solver(scaledHessian() - overstated);
    const Matrix6& axes = solver.eigenvectors();
    const Vector6 held = solver.eigenvalues().cwiseMax(0);
    confirmed = held[0];
    information = unscale.asDiagonal() * axes * held.asDiagonal() * axes.transpose() * unscale.asDiagonal();
    const Vector6 missing = (least_constraint - solver.eigenvalues().array()).max(0.0);
    hold = unscale.asDiagonal() * axes * missing.asDiagonal() * axes.transpose() * unscale.asDiagonal();
  }

  /// Smallest eigenvalue of the scaled Hessian, with what is overstated.
  double constraint() const {
    return std::max(0.0, scaledHessian().selfadjointView<Eigen::Upper>().eigenvalues()[0]);
  }
  Matrix6 scaledHessian() const { return scale.asDiagonal() * hessian * scale.asDiagonal(); }

  /// The gain is solved for beside each step (Schur complement), so that a change of exposure holds nothing.
  void add(const RefineColourSums& sums, double weight) {
    const auto all = symmetric<7>(&sums[shader::kRefineColourHessian]);
    const Eigen::Map<const Eigen::Matrix<double, 7, 1>> slope(&sums[shader::kRefineColourGradient]);
    if (!(all(6, 6) > 0)) return;
    const Vector6 mixed = all.topRightCorner<6, 1>();
    gain_slope = -mixed / all(6, 6);
    gain_step = -slope[6] / all(6, 6);
    hessian += weight * (all.topLeftCorner<6, 6>() + mixed * gain_slope.transpose());
    gradient += weight * (slope.head<6>() + mixed * gain_step);
  }
};

/// One start's descent.
struct PoseRefiner::Descent {
  Place place;
  Evaluation at;
  LocalModel model;
  std::vector<RefineSums> bands;  ///< of `at`
  double damping = 1e-3;
  int trials = 0;
  bool finished = false;
};

/// A step that a descent may take.
struct PoseRefiner::Trial {
  Descent* owner;
  Place place;
  Vector6 step;
  double damping;
};

PoseRefiner::PoseRefiner(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                         int trials_at_once)
    : settings_(settings.refine),
      weights_{static_cast<float>(settings.refine.huber), toShader(settings.depth),
               static_cast<float>(settings.refine.model_noise), settings.refine.front_only},
      colour_weight_(settings.refine.colour_weight *
                     std::pow(settings.depth.noise_floor / kLuminanceDeviation, 2)),
      measures_readout_(settings.depth.rolling_shutter && settings.depth.readout == 0),
      // A GPU evaluates a few poses in the time of one, a CPU does not.
      trials_at_once_(trials_at_once > 0                      ? trials_at_once
                      : device.info().type == DeviceType::Cpu ? 1
                                                              : 4),
      intrinsics_(intrinsics),
      camera_(toShader(intrinsics)),
      image_from_camera_(imageFromCamera(intrinsics)),
      recorder_(device),
      select_(device, camera_),
      refine_(device),
      refine_colour_(device) {}

void PoseRefiner::selectPixels(const DeviceFrame& frame, int stride, const std::optional<Pose>& last,
                               bool doubts_slopes) {
  last_ = last;
  doubts_slopes_ = last && doubts_slopes;
  coloured_ = last && colour_weight_ > 0 && frame.has_colour ? &frame : nullptr;
  asks_colour_ = false;
  select_.record(recorder_, frame, {stride, stride / 2, stride / 2}, nullptr);  // submitted with a pose
}

bool PoseRefiner::ends(const Vector6& step, double damping) const {
  return step.cwiseAbs().maxCoeff() < settings_.minimum_move || damping > kMostDamping;
}

/// The next step of a descent, and those that would follow if it and they were refused: the model stays the
/// same then, and only the damping grows.
void PoseRefiner::propose(Descent& d, int most_trials, const Pose& expected, std::vector<Trial>& trials) {
  double damping = d.damping;
  for (int k = 0; k < trials_at_once_ && !d.finished && d.trials + k < most_trials; ++k) {
    Matrix6 h = d.model.hessian + d.model.hold;
    h.diagonal() += damping * h.diagonal() + Vector6::Constant(1e-9);
    const Vector6 step = h.ldlt().solve(d.model.hold * difference(d.place.pose, expected) - d.model.gradient);
    if (!step.allFinite()) {
      d.finished = k == 0;
      return;
    }
    const double gain = d.place.gain + d.model.gain_step + d.model.gain_slope.dot(step);
    trials.push_back({&d, {moved(d.place.pose, step), gain}, step, damping});
    damping = nextDamping(damping);
    if (ends(step, damping)) return;
  }
}

std::uint64_t PoseRefiner::takePointsRead() {
  return std::exchange(points_read_, 0);
}

std::vector<PoseRefiner::Evaluation> PoseRefiner::evaluate(const Volume& volume,
                                                           std::span<const Place> places) {
  std::vector<shader::RefineCandidate> candidates;
  std::vector<shader::RefineColourCandidate> coloured;
  for (const auto& [pose, gain] : places) {
    const Eigen::Matrix4d last_image =
        last_ ? image_from_camera_ * (last_->inverse() * pose).matrix() : allInItsMiddle(camera_);
    candidates.push_back({toShader(pose), toShader(last_image)});
    coloured.push_back({toShader(pose), glm::vec4(gain, 0, 0, 0)});
  }
  refine_.record(recorder_, volume, select_, candidates, camera_, weights_);
  if (asks_colour_)
    refine_colour_.record(recorder_, volume, *coloured_, select_, camera_, coloured,
                          static_cast<float>(kLuminanceHuber));
  recorder_.submit();
  points_read_ += std::uint64_t(places.size()) * select_.selected() * (asks_colour_ ? 2 : 1);
  std::vector<Evaluation> out(places.size());
  const auto depth = refine_.sums();
  for (std::size_t i = 0; i < out.size(); ++i) out[i].depth = depth[i];
  if (!asks_colour_) return out;
  const auto sums = refine_colour_.sums();
  for (std::size_t i = 0; i < out.size(); ++i) out[i].colour = sums[i];
  return out;
}

std::vector<RefineSums> PoseRefiner::lastBands(std::size_t place) const {
  return measures_readout_ ? refine_.bands(place, kBands) : std::vector<RefineSums>{};
}

PoseFit PoseRefiner::fitOf(const Descent& d) const {
  PoseFit fit;
  fit.world_from_camera = d.place.pose;
  fit.observability = d.model.constraint();
  fit.normals =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(d.model.hessian.topLeftCorner<3, 3>()).eigenvectors();
  const RefineSums& sums = d.at.depth;
  if (sums[shader::kRefineUsable] > 0) {
    // The equations' weights are shares of the smallest variance that a depth can have.
    const double variance = kAlike * std::pow(weights_.noise.floor, 2);
    fit.covariance = (d.model.information / variance + Matrix6::Identity()).inverse();
    if (last_)
      fit.readout = readoutEvidence(d.bands, difference(*last_, d.place.pose), intrinsics_, variance);
  }
  if (sums[shader::kRefineMostCost] > 0) {
    fit.cost = sums[shader::kRefineCost] / sums[shader::kRefineMostCost];
    if (d.at.colour)
      fit.colour_cost = colour_weight_ * meanCost(*d.at.colour) * sums[shader::kRefineCostWeight] /
                        sums[shader::kRefineMostCost];
  }
  if (const double points = select_.selected(); points > 0) {
    fit.observed_ratio = sums[shader::kRefineUsable] / points;
    fit.inlier_ratio = sums[shader::kRefineClose] / points;
  }
  return fit;
}

Eigen::Matrix<double, 6, 6> PoseRefiner::overstatedAt(const Volume& volume, const Pose& pose,
                                                      const RefineSums& depth) {
  Matrix6 overstated = Matrix6::Zero();
  const LocalModel model({depth, {}}, 0, 0, overstated);
  if (model.cost_unit == 0) return overstated;
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(model.scaledHessian());
  const double probe = kProbeVoxels * volume.options().voxel_size / model.scale[0];  // without units
  std::vector<Place> places;
  for (int i = 0; i < kOpenBeforeAPlane; ++i)
    for (const double step : {-probe, probe})
      places.push_back({moved(pose, step * model.scale.asDiagonal() * solver.eigenvectors().col(i))});
  const bool asks_colour = std::exchange(asks_colour_, false);
  const std::vector<Evaluation> aside = evaluate(volume, places);
  asks_colour_ = asks_colour;
  for (int i = 0; i < kOpenBeforeAPlane; ++i) {
    const auto costAt = [&](int place) { return aside[place].depth[shader::kRefineCost]; };
    const double rise = (costAt(2 * i) + costAt(2 * i + 1)) / 2 - depth[shader::kRefineCost];
    // Rounding leaves a direction that nothing holds a little below zero.
    const double claimed = std::max(solver.eigenvalues()[i], 0.0);
    const double found = 2 * rise / (model.cost_unit * probe * probe);
    const Vector6 axis = solver.eigenvectors().col(i);
    overstated += (claimed - std::clamp(found, 0.0, claimed)) * axis * axis.transpose();
  }
  return overstated;
}

std::vector<PoseFit> PoseRefiner::refine(const Volume& volume, std::span<const Pose> starts, int iterations,
                                         const Pose& expected) {
  Matrix6 overstated = Matrix6::Zero();
  const auto modelOf = [&](const Evaluation& at) {
    return LocalModel(at, colour_weight_, settings_.least_constraint, overstated);
  };
  std::vector<Place> places;
  for (const Pose& start : starts) places.push_back({start});
  std::vector<Evaluation> first = evaluate(volume, places);
  std::vector<std::vector<RefineSums>> bands;
  for (std::size_t i = 0; i < first.size(); ++i) bands.push_back(lastBands(i));
  if (doubts_slopes_ && !first.empty()) {
    const auto costOf = [](const Evaluation& at) { return at.depth[shader::kRefineCost]; };
    const auto best = std::ranges::min_element(first, {}, costOf) - first.begin();
    overstated = overstatedAt(volume, starts[best], first[best].depth);
  }
  if (coloured_ && !asks_colour_ && volume.options().colour) {
    // Starts that are far off leave most of the points without a slope, and directions open for that alone.
    asks_colour_ = std::all_of(first.begin(), first.end(), [&](const Evaluation& at) {
      return modelOf(at).confirmed < kAsksColour * settings_.least_constraint;
    });
    if (asks_colour_) first = evaluate(volume, places);
  }
  std::vector<Descent> descents;
  for (std::size_t i = 0; i < starts.size(); ++i)
    descents.push_back({places[i], first[i], modelOf(first[i]), std::move(bands[i])});
  while (true) {
    std::vector<Trial> trials;
    for (Descent& d : descents) propose(d, iterations, expected, trials);
    if (trials.empty()) break;
    places.clear();
    for (const Trial& trial : trials) places.push_back(trial.place);
    const std::vector<Evaluation> found = evaluate(volume, places);
    for (std::size_t k = 0; k < trials.size(); ++k) {
      Descent& d = *trials[k].owner;
      // Those after one that was accepted, or that ended the descent, were asked for in vain.
      if (d.finished || trials[k].damping != d.damping) continue;
      // Hold and colour are in units of the normal equations' weights, the cost in its own.
      const double unit = d.model.cost_unit;
      const auto objective = [&](const Pose& pose, const Evaluation& at) {
        const Vector6 off = difference(pose, expected);
        const double depth = at.depth[shader::kRefineCost] + 0.5 * unit * off.dot(d.model.hold * off);
        if (!at.colour) return depth;
        const double points = (*d.at.colour)[shader::kRefineColourPoints];
        return depth + unit * colour_weight_ * points * meanCost(*at.colour);
      };
      ++d.trials;
      const bool better = objective(trials[k].place.pose, found[k]) < objective(d.place.pose, d.at);
      d.damping = better ? std::max(d.damping * 0.1, kLeastDamping) : nextDamping(d.damping);
      if (better) {
        d.place = trials[k].place;
        d.at = found[k];
        d.model = modelOf(found[k]);
        d.bands = lastBands(k);
      }
      d.finished = ends(trials[k].step, d.damping);
    }
  }
  std::vector<PoseFit> fits;
  for (const Descent& d : descents) fits.push_back(fitOf(d));
  return fits;
}

}  // namespace rosefusion
