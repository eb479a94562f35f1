// tracking by each of the methods, and the switches of the ablations.
#include "host/evaluation/trajectory_error.h"
#include "host/slam/pipeline.h"
#include "tests/engine/validating_device.h"
#include "tests/host/slam/short_sequence.h"

namespace rosefusion::testing {
namespace test_pose_methods {

/// Slow enough for the methods that only descend, and yet some way to go.
const SynthSequence& slowSequence() {
  static const SynthSequence sequence = [] {
    SynthOptions options;
    options.seed = kAnyRoom;
    options.frames = 8;
    options.linear = {0.6, 0.9, 1.3};
    options.angular = {0.2, 0.4, 0.6};
    options.ramp = 0.05;
    options.intrinsics = {320, 240, 160, 160, 159.5, 119.5};
    return makeSequence(options);
  }();
  return sequence;
}

class PoseMethods : public ValidatingDevice {
 protected:
  struct Tracked {
    Trajectory trajectory;
    std::uint64_t lookups = 0;
    int iterations = 0;
  };
  Tracked track(const std::vector<std::string>& assignments) {
    Settings settings = quickSettings();
    for (const std::string& assignment : assignments) applyAssignment(settings, assignment);
    const SynthSequence& sequence = slowSequence();
    Pipeline pipeline(device(), settings, sequence.intrinsics, sequence.depth_units_per_metre);
    Tracked out;
    for (const Frame& frame : sequence.frames) {
      const FrameResult result = pipeline.processFrame(frame);
      out.trajectory.push_back({result.timestamp, result.world_from_camera});
      out.lookups += result.lookups;
      out.iterations += result.iterations;
    }
    return out;
  }
  /// The largest error without alignment: a camera that is taken to stand still is off by all that it moved.
  static double te(const Tracked& tracked) {
    return measureTrajectory(tracked.trajectory, slowSequence().truth).te_m.max;
  }
  static bool same(const Tracked& a, const Tracked& b) {
    for (std::size_t i = 0; i < a.trajectory.size(); ++i)
      if (a.trajectory[i].world_from_camera.matrix() != b.trajectory[i].world_from_camera.matrix())
        return false;
    return true;
  }
};

TEST_F(PoseMethods, EachTracksASlowCameraRepeatably) {
  const std::string kParticles = "swarm.levels=4096/16 1024/8 512/4";  // this fast, fewer miss too much
  const Trajectory& truth = slowSequence().truth;
  const double travelled =
      (truth.back().world_from_camera.translation() - truth[0].world_from_camera.translation()).norm();
  ASSERT_GT(travelled, 0.1);
  std::vector<Tracked> all;
  for (const char* method : {"default", "pst", "pfo", "pso", "gauss-newton", "icp"}) {
    const std::string assignment = std::string("tracking.method=") + method;
    all.push_back(track({assignment, kParticles}));
    EXPECT_LT(te(all.back()), 0.5 * travelled) << method;
    EXPECT_GT(all.back().lookups, 0u) << method;
    EXPECT_GT(all.back().iterations, 0) << method;
    EXPECT_TRUE(same(all.back(), track({assignment, kParticles}))) << method;
    for (std::size_t i = 0; i + 1 < all.size(); ++i) EXPECT_FALSE(same(all[i], all.back())) << method;
  }
}

TEST_F(PoseMethods, PresetsNameTheirMethod) {
  EXPECT_EQ(loadSettings("paper").tracking.method, TrackingMethod::Pst);
  EXPECT_EQ(loadSettings("default").tracking.method, TrackingMethod::Default);
}

TEST_F(PoseMethods, SwarmsSpendTheSameBudget) {
  const std::vector<std::string> fixed{"swarm.max_empty_sets=1000", "swarm.minimum_move=0",
                                       "swarm.max_iterations=6", "tracking.overlap=none"};
  std::vector<Tracked> all;
  for (const char* method : {"pst", "pfo", "pso"}) {
    std::vector<std::string> assignments = fixed;
    assignments.push_back("swarm.restart_levels_when_empty=false");
    assignments.push_back(std::string("tracking.method=") + method);
    all.push_back(track(assignments));
  }
  for (const Tracked& tracked : all) {
    EXPECT_EQ(tracked.iterations, all[0].iterations);
    EXPECT_EQ(tracked.lookups, all[0].lookups);
  }
}

TEST_F(PoseMethods, EveryAblationChangesTheSearch) {
  const Tracked ours = track({});
  for (const char* off : {"tracking.overlap=none", "tracking.normalise=false", "tracking.compensate=false",
                          "swarm.rescaling=anisotropic", "swarm.rescaling=isotropic", "swarm.levels=512/8"})
    EXPECT_FALSE(same(ours, track({off}))) << off;
}

}  // namespace test_pose_methods
}  // namespace rosefusion::testing
