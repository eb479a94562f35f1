// Moves poses onto the model's surface: damped Gauss-Newton on the trilinear TSDF (after Bylow et al. 2013),
// several starts at once; the sums come from the device, the 6 x 6 systems are solved here.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "engine/passes/refine.h"
#include "host/camera.h"
#include "host/settings.h"

namespace rosefusion {

inline constexpr int kVoxelsPerPoint = 27;  ///< that the descent reads

/// `pose` shifted in the world by the first three of `step` and turned about its own centre by the last
/// three, a rotation vector applied from the left.
Pose moved(const Pose& pose, const Eigen::Matrix<double, 6, 1>& step);

/// How the depth fits the model at a pose. Shares are of the frame's valid pixels on the grid looked at.
struct PoseFit {
  Pose world_from_camera = Pose::Identity();
  double cost = 1;        ///< robust, in [0, 1]: 1 where no point finds a surface
  double usable = 0;      ///< share that reads a distance
  double close = 0;       ///< share nearer to the surface than refine.huber
  double constraint = 0;  ///< how firmly the depth holds the least constrained direction; a plane's own is 1

  /// Whether a pose may be believed by this alone: at least `share` of the pixels reads a distance, three
  /// quarters of those are close, and every direction is held by `least_constraint`.
  bool holds(double share, double least_constraint) const {
    return usable >= share && close >= 0.75 * usable && constraint >= least_constraint;
  }
};

class Refiner {
 public:
  Refiner(Device& device, const Settings& settings, const Intrinsics& intrinsics);

  /// Which pixels the next calls look at: every stride-th of the frame. `last`: the last frame's pose; what
  /// its image did not hold may be missing in the model. Without it, whatever is missing counts against a
  /// pose.
  void look(const PreprocessPass& frame, int stride, const std::optional<Pose>& last = {});
  /// Descends from each start; the results keep the starts' order. `expected`: the pose that the motion model
  /// speaks for; it decides in directions that the depth does not constrain (refine.least_constraint).
  std::vector<PoseFit> refine(const Volume& volume, std::span<const Pose> starts, int iterations,
                              const Pose& expected);
  /// Points read since the last call of this, over all poses.
  std::uint64_t takePointsRead();

 private:
  std::vector<RefineSums> evaluate(const Volume& volume, std::span<const Pose> poses);

  const RefineSettings settings_;
  const RefineWeights weights_;
  const glm::ivec2 image_size_;
  const Eigen::Matrix4d image_from_camera_;
  std::optional<Pose> last_;
  Recorder recorder_;
  SelectPointsPass select_;
  RefinePass refine_;
  std::uint64_t points_read_ = 0;
};

}  // namespace rosefusion
