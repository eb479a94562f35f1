// A loop that closes moves what the viewer has already drawn: its path and the trajectory that it saves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <opencv2/imgcodecs.hpp>

#include "apps/viewer/session.h"
#include "tests/engine/validating_device.h"
#include "tests/host/core/temporary_folder.h"
#include "tests/host/slam/loop_closure/ring_walk.h"

namespace rosefusion::testing {
namespace test_session_loops {
using namespace viewer;

double errorOfEnd(const Eigen::Vector3d& position) {
  return (ringPose(0).inverse() * ringPose(ringWay(kRingFrames - 1)).translation() - position).norm();
}

constexpr std::size_t kTrueAgain = 82;  // depths are no longer scaled, and no loop is closed yet

TEST(SessionLoops, TheDrawnPathIsCorrected) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "depth");
  for (int i = 0; i < kRingFrames; ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "depth/%03d.png", i);
    cv::imwrite((folder / name).string(), ringFrames()[static_cast<std::size_t>(i)].depth);
  }
  folder.write("sequence.yaml",
               "intrinsics: {fx: 80, fy: 80, cx: 79.5, cy: 59.5}\n"
               "depth_units_per_metre: 5000\ndepth: depth/*.png\nfps: 30\n");
  Device device(deviceUnderTest());
  Session session(device, ringSettings(true), {});
  session.open(folder.path().string());
  session.waitUntilIdle();
  const Snapshot opened = session.snapshot();
  if (opened.phase == Phase::Failed) GTEST_SKIP() << opened.message;
  session.play();
  session.waitUntilIdle();
  session.saveTrajectory(folder / "trajectory.txt");
  session.waitUntilIdle();

  const Snapshot seen = session.snapshot();
  const Trajectory saved = readTumTrajectory(folder / "trajectory.txt");
  ASSERT_EQ(seen.path->size(), std::size_t(kRingFrames)) << seen.message;
  ASSERT_EQ(saved.size(), seen.path->size());
  double widest = 0, fastest = 0;
  for (std::size_t i = 0; i < saved.size(); ++i) {
    const PathPoint& shown = (*seen.path)[i];
    EXPECT_LT((saved[i].world_from_camera.translation() - shown.position).norm(), 1e-5) << i;
    if (i < kTrueAgain) continue;
    widest = std::max(widest, (shown.position - (*seen.path)[i - 1].position).norm());
    fastest = std::max(fastest, shown.speed);
  }
  // With template seeds 1 to 6: 4.0 to 5.9 cm, 18 to 21 cm, 4.2 to 4.6 m/s. The loop moves the camera by 37
  // cm and more: that much off without it, so wide a step in a path left as it was, and 11 m/s if it passed
  // for motion.
  EXPECT_LT(errorOfEnd(seen.path->back().position), 0.1) << "a loop must close, or this shows nothing";
  EXPECT_LT(widest, 0.3) << "the path before the closure is corrected with it: a step is 12 cm";
  EXPECT_LT(fastest, 6) << "a correction is no motion: the camera walks at 3.6 m/s";
  EXPECT_EQ(seen.last->world_from_camera.translation(), seen.path->back().position) << "the frustum";
  EXPECT_THAT(device.validationMessages(), ::testing::IsEmpty());
}

}  // namespace test_session_loops
}  // namespace rosefusion::testing
