// Where the overview's camera stands.
#include "host/run/preview.h"
#include "tests/engine/validating_device.h"
#include "tests/host/slam/short_sequence.h"

namespace rosefusion::testing {
namespace test_preview {

class Preview : public ValidatingDevice {};

TEST_F(Preview, AllOfThePathIsInThePicture) {
  const SynthSequence& sequence = shortSequence();
  Pipeline pipeline(device(), quickSettings(), sequence.intrinsics, sequence.depth_units_per_metre);
  pipeline.processFrame(sequence.frames[0]);
  const Intrinsics view{640, 400, 575, 575, 319.5, 199.5};
  // As of a camera that stood before what it saw, and then backed away from it.
  Trajectory path;
  for (int i = 0; i < 5; ++i) path.push_back({0.1 * i, Pose(Eigen::Translation3d(0.5 * i, 0, -1.5 * i))});
  const auto outside = [&](const Pose& camera) {
    int count = 0;
    for (const StampedPose& p : path) {
      const Eigen::Vector3d at = camera.inverse() * p.world_from_camera.translation();
      const Eigen::Vector2d pixel = view.project(at);
      count +=
          at.z() <= 0 || pixel.x() < 0 || pixel.y() < 0 || pixel.x() > view.width || pixel.y() > view.height;
    }
    return count;
  };
  const Pose near = overviewPose(pipeline.volume(), {path.front()}, view);
  EXPECT_GT(outside(near), 0) << "the model alone must not show the path, or this shows nothing";
  const Pose far = overviewPose(pipeline.volume(), path, view);
  EXPECT_EQ(outside(far), 0);
  EXPECT_TRUE(far.linear().isApprox(near.linear()));
  EXPECT_LT((far.translation() - near.translation()).norm(), 20);
}

}  // namespace test_preview
}  // namespace rosefusion::testing
