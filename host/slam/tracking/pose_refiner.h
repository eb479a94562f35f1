// Moves poses onto the model's surface: damped Gauss-Newton on the trilinear TSDF (after Bylow et al. 2013),
// several starts at once; the sums come from the device, the 6 x 6 systems are solved here. Where depth
// leaves a direction open, the luminance of image and model is compared as well.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "engine/passes/refine.h"
#include "engine/passes/refine_colour.h"
#include "host/settings/settings.h"
#include "host/slam/tracking/pose_estimate.h"

namespace rosefusion {

inline constexpr int kVoxelsPerPoint = 27;  ///< that the descent reads
/// Up to so many times refine.least_constraint colour still holds a pose better than depth alone. Beyond,
/// colour that was taken at another moment than its depth costs more than it brings.
inline constexpr double kAsksColour = 12;

class PoseRefiner {
 public:
  /// `trials_at_once`: steps of a descent that are evaluated together, 0 chooses by the device. The poses
  /// found are the same bits whatever it is.
  PoseRefiner(Device& device, const Settings& settings, const Intrinsics& intrinsics, int trials_at_once = 0);

  void prepare(const VolumeView& volume) { refine_.prepare(volume); }
  /// Which pixels the next calls look at: every stride-th of the frame, which must outlive them. `last`: the
  /// last frame's pose; what its image did not hold may be missing in the model. Without it, whatever is
  /// missing counts against a pose, and colour is not asked.
  /// `doubts_slopes`: constraints that the cost does not confirm, since only noise feigns them, count for
  /// nothing; none are doubted without `last`.
  void selectPixels(const DeviceFrame& frame, int stride, const std::optional<Pose>& last = {},
                    bool doubts_slopes = true);
  /// Descends from each start; the results keep the starts' order. `expected`: the pose that the motion model
  /// speaks for; it decides in directions that neither depth nor, with refine.colour_weight, colour
  /// constrains (refine.least_constraint). Once depth holds no start of a call firmly (kAsksColour), colour
  /// is asked until the next selectPixels().
  std::vector<PoseFit> refine(const Volume& volume, std::span<const Pose> starts, int iterations,
                              const Pose& expected);
  /// Points read since the last call of this, over all poses.
  std::uint64_t takePointsRead();

 private:
  struct Place {
    Pose pose;
    double gain = 1;  ///< brightness of the frame, in units of the model's
  };
  struct Evaluation {
    RefineSums depth{};
    std::optional<RefineColourSums> colour;
  };
  struct LocalModel;
  struct Descent;
  struct Trial;
  /// What the normal equations at a pose claim to hold, without units, and the cost around it does not: noise
  /// of the model's slopes feigns constraints before flat walls.
  Eigen::Matrix<double, 6, 6> overstatedAt(const Volume& volume, const Pose& pose, const RefineSums& depth);
  bool ends(const Vector6& step, double damping) const;
  void propose(Descent& descent, int most_trials, const Pose& expected, std::vector<Trial>& trials);
  std::vector<Evaluation> evaluate(const Volume& volume, std::span<const Place> places);
  /// Of what was evaluated last; none where nobody asks for them.
  std::vector<RefineSums> lastBands(std::size_t place) const;
  PoseFit fitOf(const Descent& descent) const;

  const RefineSettings settings_;
  const RefineWeights weights_;
  const double colour_weight_;  ///< of a squared luminance, in squared metres
  const bool measures_readout_;
  const int trials_at_once_;
  const Intrinsics intrinsics_;
  const shader::CameraIntrinsics camera_;
  const Eigen::Matrix4d image_from_camera_;
  std::optional<Pose> last_;
  Recorder recorder_;
  SelectPointsPass select_;
  RefinePass refine_;
  RefineColourPass refine_colour_;
  const DeviceFrame* coloured_ = nullptr;  ///< the frame looked at, where its colour may be asked
  bool asks_colour_ = false;
  bool doubts_slopes_ = false;
  std::uint64_t points_read_ = 0;
};

}  // namespace rosefusion
