// Every constant of the pose search, named after the equation of the paper (ROSEFusion, ACM TOG 2021) it
// comes from.
#pragma once
#include <vector>

namespace rosefusion {

enum class FitnessLoss {
  Squared,   ///< the paper: fitness = exp(-mean psi^2 / tau) [eq. normallh]
  Absolute,  ///< the authors' release: fitness = 1 - mean |psi|
};

enum class FrameStart {
  PreviousFirstLengths,  ///< the paper: r0 of frame t + 1 is r1 of frame t [PST initialization]
  FailureLoss,  ///< the release: a sphere scaled by the loss at which the search last failed to improve
};

/// Which parts of [eq. rsinter] rescale the swarm; the others are the paper's ablation.
enum class Rescaling {
  Both,
  Anisotropic,  ///< the attractor alone: 1 - rho stays 1 - initial_likelihood
  Isotropic,    ///< 1 - rho alone, on every axis
};

/// One resolution of the search [Multi-resolution PST].
struct SwarmLevel {
  int particles = 0;
  int pixel_stride = 0;  ///< every pixel_stride-th pixel of every pixel_stride-th row is looked up
  bool operator==(const SwarmLevel&) const = default;
};

/// Defaults are the paper's; where it is silent they are the release's, and the comment says so.
struct SwarmSettings {
  FitnessLoss loss = FitnessLoss::Squared;
  double tau = 1.0;  ///< temperature [eq. pfolh]; Squared only

  /// A particle counts only with more than this share of particle 0's pixels (release); 0 takes every
  /// particle that has any. The paper counts the same pixels for all, so that the test never bites.
  double minimum_counted_share = 0.5;
  int max_advantage_particles =
      0;  ///< advantage particles averaged, in template order; 0 = all (paper), release 200

  double axis_scale = 1.0;  ///< factor of (1 - rho) v / |v| [eq. rsinter]; release 0.09
  Rescaling rescaling = Rescaling::Both;
  double axis_epsilon = 1e-3;  ///< epsilon, keeps the template from degenerating [eq. rsinter]
  double axis_momentum = 0.1;  ///< beta, the previous lengths' share [eq. momentum]
  double empty_set_scale =
      2.0;  ///< factor of (1 - rho) v / |v| after an empty advantage set [PST update, second case]
  double initial_likelihood = 0.5;  ///< where no likelihood can be measured [PST update, first case]
  double first_axis_scale =
      1.0;  ///< r = first_axis_scale (1 - initial_likelihood) on every axis [same]; release 0.18
  FrameStart frame_start = FrameStart::PreviousFirstLengths;

  std::vector<SwarmLevel> levels = {{10240, 32}, {3072, 16}, {1024, 8}};  ///< used in turn, from the first
  bool restart_levels_when_empty = true;  ///< release: an empty advantage set leads back to the first level
  int pixel_shift = 5;  ///< pixels the sampled grid moves each iteration (release), so all get their turn

  int max_iterations = 20;  ///< [Convergence criteria]
  int max_empty_sets = 2;   ///< empty advantage sets in a row that end the search [Convergence criteria]
  double minimum_move =
      1e-6;  ///< a move below this in all six dimensions ends the search [Convergence criteria]
  bool operator==(const SwarmSettings&) const = default;
};

/// Particle filter optimisation without swarm guidance [section 4.1]: a Gaussian proposal around resampled
/// particles.
struct PfoSettings {
  double shift_deviation = 0.01;  ///< metres, of the proposal [eq. proposal]
  double turn_deviation = 0.005;  ///< of the quaternion's imaginary part
  double temperature = 0.02;      ///< tau of the weights exp(-(loss - best loss) / tau) [eq. pfolh]
};

/// Particle swarm optimisation (Kennedy and Eberhart 1995) with the constriction of Clerc and Kennedy (2002).
struct PsoSettings {
  double inertia = 0.7298;
  double own_pull = 1.49618;    ///< towards the best place that the particle itself has seen
  double swarm_pull = 1.49618;  ///< towards the best place of all
};

/// The method of the paper: the defaults.
SwarmSettings paperSwarmSettings();

/// What the authors' public release is known to do differently (facts only; its code is not used).
SwarmSettings releaseSwarmSettings();

/// Throws InputError that names the field when a value is out of range.
void requireValid(const SwarmSettings& settings);

}  // namespace rosefusion
