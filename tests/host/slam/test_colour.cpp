// The colour of a wall holds the camera where its depth does not.
#include "host/slam/pipeline.h"
#include "host/synth/noise.h"
#include "host/synth/renderer.h"
#include "host/synth/sequence.h"
#include "host/synth/shapes.h"
#include "tests/engine/validating_device.h"

namespace rosefusion::testing {
namespace test_colour {

constexpr int kFrames = 20;
const Intrinsics kCamera{160, 120, 80, 80, 79.5, 59.5};

/// To and fro along a wall 1.5 m away, up to 1.9 m/s, turning about its normal: nothing that depth could
/// hold.
Pose poseAt(int i) {
  const double phase = 2 * 3.14159265 * i / 30;
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(0.3 * (1 - std::cos(phase)), 0.1 * std::sin(phase), 0);
  pose.linear() = Eigen::AngleAxisd(0.1 * std::sin(phase), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

struct Outcome {
  double worst_m = 0;
  double motion_m = 0;
  int tracked = 0;
};

class ColourTracking : public ValidatingDevice {
 protected:
  /// `exposure`: how far the camera's brightness goes up and down.
  static Outcome fly(const Material& wall, double colour_weight, double exposure = 0, bool colour = true) {
    Scene scene;
    const ShapeBuilder shapes(scene, Eigen::Isometry3d::Identity());
    shapes.quad({-3, -2, 1.5}, {0, 4, 0}, {6, 0, 0}, shapes.addMaterial(wall));
    const Tracer tracer(scene);
    Settings settings = loadSettings("default");
    applyAssignment(settings, "swarm.levels=1024/16 512/8 256/4");
    applyAssignment(settings, "tracking.templates_per_level=3");
    settings.refine.colour_weight = colour_weight;
    Pipeline pipeline(device(), settings, kCamera, kSynthDepthUnitsPerMetre);
    Rng rng(41);
    Outcome out;
    for (int i = 0; i < kFrames; ++i) {
      Frame frame;
      frame.timestamp = i / 30.0;
      addHandaNoise(renderDepth(tracer, kCamera, poseAt(i)), rng)
          .convertTo(frame.depth, CV_16UC1, kSynthDepthUnitsPerMetre);
      if (colour) {
        renderColour(tracer, kCamera, poseAt(i))
            .convertTo(frame.colour, CV_8UC3, 1 + exposure * std::sin(0.4 * i));
        addColourNoise(frame.colour, rng);
      }
      const FrameResult result = pipeline.processFrame(frame);
      EXPECT_NE(result.status, TrackingStatus::Lost) << "frame " << i << ": " << result.reason;
      // The second frame meets a model of one noisy image, whose noise alone can seem to hold it.
      out.tracked += i > 1 && result.status == TrackingStatus::Tracked;
      const Eigen::Vector3d truth = poseAt(i).translation();
      out.worst_m = std::max(out.worst_m, (result.world_from_camera.translation() - truth).norm());
      out.motion_m = std::max(out.motion_m, truth.norm());
    }
    return out;
  }
};

const Material kPlaster{{190, 180, 165}, Pattern::Noise, 0.15f};  // what `synth --mesh` paints walls with

TEST_F(ColourTracking, PaintHoldsTheCameraPastABareWall) {
  const Outcome with = fly(kPlaster, 1), without = fly(kPlaster, 0);
  EXPECT_GT(without.motion_m, 0.5);
  EXPECT_GT(without.worst_m, 0.1) << "the wall must be one that depth slides along";
  EXPECT_EQ(without.tracked, 0);
  EXPECT_LT(with.worst_m, 0.02);
  EXPECT_GE(with.tracked, kFrames - 3) << "where the plaster is faintest, a frame may stay open";
}

TEST_F(ColourTracking, AnExposureThatChangesDoesNotPull) {
  const Outcome found = fly(kPlaster, 1, 0.2);
  EXPECT_LT(found.worst_m, 0.02);
  EXPECT_GE(found.tracked, kFrames - 3);
}

TEST_F(ColourTracking, AWallWithoutAPatternIsUncertain) {
  EXPECT_EQ(fly({{190, 180, 165}, Pattern::Plain, 0.15f}, 1).tracked, 0);
}

TEST_F(ColourTracking, WithoutColourTheSettingChangesNothing) {
  const Outcome on = fly(kPlaster, 1, 0, false), off = fly(kPlaster, 0, 0, false);
  EXPECT_EQ(on.worst_m, off.worst_m);
  EXPECT_EQ(on.tracked, off.tracked);
}

}  // namespace test_colour
}  // namespace rosefusion::testing
