// A camera that stays lost goes on in a map of its own, which is joined to the first once a place connects
// them.
#include "host/slam/pipeline.h"
#include "tests/engine/validating_device.h"
#include "tests/host/slam/short_sequence.h"

namespace rosefusion::testing {
namespace test_detached_maps {

class SecondMap : public ValidatingDevice {
 protected:
  static Frame darkened(Frame frame) {
    frame.depth = cv::Mat(frame.depth.size(), CV_16UC1, cv::Scalar(0));
    return frame;
  }
  static Pipeline make(const SynthSequence& sequence, const std::string& assignment = "loops.enabled=0") {
    Settings settings = loadSettings("default");
    applyAssignment(settings, assignment);
    return {device(), settings, sequence.intrinsics, sequence.depth_units_per_metre};
  }
  /// Of poses in `trajectory`, each relative to its first; metres.
  static double largestError(const Trajectory& trajectory, const SynthSequence& sequence) {
    const auto truthAt = [&](double timestamp) {
      const auto i = static_cast<std::size_t>(std::lround(timestamp * 30));
      return sequence.truth.at(i).world_from_camera;
    };
    const Pose first = truthAt(trajectory.front().timestamp);
    double largest = 0;
    for (const StampedPose& pose : trajectory)
      largest = std::max(largest,
                         shiftBetween(trajectory.front().world_from_camera.inverse() * pose.world_from_camera,
                                      first.inverse() * truthAt(pose.timestamp)));
    return largest;
  }
};

// Dark for 85 frames while it flies to the other end of the room, and back where it began 90 frames later.
TEST_F(SecondMap, JoinsTheFirstMapAtAKnownPlace) {
  const SynthSequence sequence = makeShortSequence(kRoomFlownThereAndBack, 225);
  Pipeline pipeline = make(sequence);
  constexpr std::size_t kDark = 20, kLight = 105;
  std::size_t detached = 0, joined_at = 0;
  std::uint32_t blocks_before = 0;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const bool dark = i >= kDark && i < kLight;
    const FrameResult result =
        pipeline.processFrame(dark ? darkened(sequence.frames[i]) : sequence.frames[i]);
    ASSERT_EQ(pipeline.trajectory().size(),
              result.number ? *result.number + 1 : pipeline.trajectory().size());
    if (dark) {
      EXPECT_FALSE(result.detached_map);
    } else if (i >= kLight && joined_at == 0 && result.joined.empty()) {
      detached += result.detached_map == 2U;
      blocks_before = pipeline.volume().blockCount();
    }
    if (!result.joined.empty()) {
      joined_at = i;
      ASSERT_EQ(result.joined.size(), 1u);
      EXPECT_EQ(result.joined[0].map, 2u);
      EXPECT_EQ(result.joined[0].into, 1u);
      EXPECT_GT(result.recovered.size(), 10u)
          << "the others were found in the first map before it believed them";
      EXPECT_GT(pipeline.volume().blockCount(), blocks_before + blocks_before / 4)
          << "the model grows by the other";
    }
  }
  ASSERT_GT(joined_at, 0u);
  EXPECT_GT(detached, 20u);
  EXPECT_TRUE(pipeline.detachedMaps().empty());
  // Every frame with depth has a pose in the end, in ascending order and all of them right.
  const Trajectory& trajectory = pipeline.trajectory();
  EXPECT_EQ(trajectory.size(), sequence.frames.size() - (kLight - kDark));
  for (std::size_t i = 1; i < trajectory.size(); ++i)
    EXPECT_LT(trajectory[i - 1].timestamp, trajectory[i].timestamp);
  EXPECT_LT(largestError(trajectory, sequence), 0.03);
}

// Two rooms that nothing connects: neither is thrown away, and neither is put into the other.
TEST_F(SecondMap, WhatNothingConnectsStaysApart) {
  const SynthSequence here = makeShortSequence(kRoomWithoutWindows, 12),
                      there = makeShortSequence(kUnlikeRoom, 24);
  Pipeline pipeline = make(here);
  double now = 0;
  const auto show = [&](Frame frame) {
    frame.timestamp = now;
    now += 1.0 / 30;
    return pipeline.processFrame(frame);
  };
  for (const Frame& frame : here.frames) EXPECT_NE(show(frame).status, TrackingStatus::Lost);
  const std::uint32_t blocks = pipeline.volume().blockCount();
  for (int i = 0; i < 35; ++i) EXPECT_EQ(show(darkened(here.frames[0])).status, TrackingStatus::Lost);
  for (const Frame& frame : there.frames) {
    const FrameResult result = show(frame);
    EXPECT_EQ(result.status, TrackingStatus::Lost);
    EXPECT_EQ(result.reason, Reason::InDetachedMap) << result.reason;
  }
  ASSERT_EQ(pipeline.detachedMaps().size(), 1u);
  const Trajectory& apart = pipeline.detachedMaps()[0]->map.trajectory;
  ASSERT_EQ(apart.size(), there.frames.size());
  for (std::size_t i = 0; i < apart.size(); ++i)
    EXPECT_LT(errorAt(i, apart[i].world_from_camera, there), 0.02);
  EXPECT_EQ(pipeline.volume().blockCount(), blocks);
  EXPECT_EQ(pipeline.trajectory().size(), here.frames.size());
}

// With loops.enabled stored images make the model, and the loop closer looks for the place itself.
TEST_F(SecondMap, AShortLossBeginsNone) {
  const SynthSequence sequence = makeShortSequence(kRoomWithoutWindows, 12);
  Pipeline pipeline = make(sequence);
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const bool dark = i >= 4 && i < 9;
    EXPECT_FALSE(
        pipeline.processFrame(dark ? darkened(sequence.frames[i]) : sequence.frames[i]).detached_map);
  }
  EXPECT_TRUE(pipeline.detachedMaps().empty());
}

}  // namespace test_detached_maps
}  // namespace rosefusion::testing
