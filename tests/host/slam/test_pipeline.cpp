// The pipeline frame by frame: it follows the camera, says when it cannot, and repeats itself exactly.
#include <cmath>

#include "host/core/error.h"
#include "host/slam/pipeline.h"
#include "host/synth/renderer.h"
#include "tests/engine/validating_device.h"
#include "tests/host/slam/short_sequence.h"

namespace rosefusion::testing {
namespace test_pipeline {

class FrameByFrame : public ValidatingDevice {
 protected:
  static Pipeline make(const Settings& settings = quickSettings()) {
    return {device(), settings, shortSequence().intrinsics, shortSequence().depth_units_per_metre};
  }
};

TEST_F(FrameByFrame, IsFoundAgainAfterAFrameWithoutDepth) {
  const SynthSequence sequence = makeShortSequence(kRoomSeenAgain, 24);
  Pipeline pipeline(device(), loadSettings("default"), sequence.intrinsics, sequence.depth_units_per_metre);
  const auto run = [&](std::size_t i) { return pipeline.processFrame(sequence.frames[i]); };
  for (std::size_t i = 0; i < 12; ++i) EXPECT_NE(run(i).status, TrackingStatus::Lost) << "frame " << i;
  Frame empty = sequence.frames[12];
  empty.depth = cv::Mat(empty.depth.size(), CV_16UC1, cv::Scalar(0));
  EXPECT_EQ(pipeline.processFrame(empty).status, TrackingStatus::Lost);
  const auto before = pipeline.volume().download();
  const FrameResult found = run(4), agreeing = run(5);  // where it has been
  EXPECT_EQ(found.status, TrackingStatus::Lost) << "one image is not enough to tell a pose";
  EXPECT_EQ(found.reason, Reason::Tentative);
  EXPECT_EQ(agreeing.status, TrackingStatus::Relocalised) << agreeing.reason;
  EXPECT_LT(errorAt(5, agreeing.world_from_camera, sequence), 0.03);
  EXPECT_EQ(pipeline.volume().download().weight, before.weight) << "nothing is fused before frames agree";
  EXPECT_EQ(run(6).status, TrackingStatus::Tracked);
  EXPECT_NE(pipeline.volume().download().weight, before.weight);
}

TEST_F(FrameByFrame, AnUnconfirmedPlaceIsForgotten) {
  const SynthSequence sequence = makeShortSequence(kRoomSeenAgain, 24),
                      other = makeShortSequence(kForeignRoom, 2);
  Pipeline pipeline(device(), loadSettings("default"), sequence.intrinsics, sequence.depth_units_per_metre);
  const auto run = [&](const Frame& frame) { return pipeline.processFrame(frame); };
  FrameResult last;
  for (std::size_t i = 0; i < 12; ++i) last = run(sequence.frames[i]);
  ASSERT_NE(last.status, TrackingStatus::Lost) << last.reason;
  Frame empty = sequence.frames[12];
  empty.depth = cv::Mat(empty.depth.size(), CV_16UC1, cv::Scalar(0));
  run(empty);
  ASSERT_EQ(run(sequence.frames[4]).reason, Reason::Tentative);
  const FrameResult strange = run(other.frames[0]);
  EXPECT_EQ(strange.status, TrackingStatus::Lost) << strange.reason;
  EXPECT_EQ(strange.world_from_camera.matrix(), last.world_from_camera.matrix());
  EXPECT_EQ(run(sequence.frames[12]).status, TrackingStatus::Lost);
  const FrameResult found = run(sequence.frames[13]);
  EXPECT_EQ(found.status, TrackingStatus::Relocalised) << found.reason;
  EXPECT_LT(errorAt(13, found.world_from_camera, sequence), 0.03);
}

// Its motion tells where it has got to; among all keyframes' surroundings other places look likelier.
TEST_F(FrameByFrame, ACameraThatMovedOnInTheDarkIsFoundAtOnce) {
  constexpr std::size_t kDark = 120, kLight = 130;
  constexpr std::size_t kLast = kLight + 1;  // half of the image is known until then
  const SynthSequence sequence = makeShortSequence(kRoomCrossedInTheDark, 240);
  Pipeline pipeline(device(), loadSettings("default"), sequence.intrinsics, sequence.depth_units_per_metre);
  FrameResult result;
  for (std::size_t i = 0; i <= kLast; ++i) {
    Frame frame = sequence.frames[i];
    const bool dark = i >= kDark && i < kLight;
    if (dark) frame.depth = cv::Mat(frame.depth.size(), CV_16UC1, cv::Scalar(0));
    result = pipeline.processFrame(frame);
    if (i >= kLight) continue;
    ASSERT_EQ(result.status == TrackingStatus::Lost, dark) << "frame " << i << ": " << result.reason;
  }
  EXPECT_EQ(result.status, TrackingStatus::Relocalised) << result.reason;
  EXPECT_LT(errorAt(kLast, result.world_from_camera, sequence), 0.03);
}

/// Shows the pipeline a sequence's first `known` frames at their true poses, and then nothing.
void showThenDarken(Pipeline& pipeline, const SynthSequence& sequence, std::size_t known) {
  const Pose first_from_world = sequence.truth[0].world_from_camera.inverse();
  for (std::size_t i = 0; i < known; i += 2)
    pipeline.fuseFrame(sequence.frames[i], first_from_world * sequence.truth[i].world_from_camera);
  Frame dark = sequence.frames[known];
  dark.depth = cv::Mat(dark.depth.size(), CV_16UC1, cv::Scalar(0));
  ASSERT_EQ(pipeline.processFrame(dark).status, TrackingStatus::Lost);
}

// Metres from wherever the camera was before, in a view of which less than half is known.
TEST_F(FrameByFrame, ACameraCarriedAcrossTheRoomIsFound) {
  const SynthSequence sequence = makeShortSequence(kRoomWithFarEnd, 240);
  Pipeline pipeline(device(), loadSettings("default"), sequence.intrinsics, sequence.depth_units_per_metre);
  constexpr std::size_t kKnown = 120, kFound = 201;
  showThenDarken(pipeline, sequence, kKnown);
  const auto positionAt = [&](std::size_t i) { return sequence.truth[i].world_from_camera.translation(); };
  for (std::size_t i = 0; i < kKnown; ++i) EXPECT_GT((positionAt(i) - positionAt(kFound)).norm(), 1.5);
  // The unknown may be a hand, and the rest may look like another place: told once ten frames agree.
  constexpr std::size_t kTold = kFound + 9;
  for (std::size_t i = kFound; i <= kTold; ++i) {
    const FrameResult result = pipeline.processFrame(sequence.frames[i]);
    EXPECT_EQ(result.status, i < kTold ? TrackingStatus::Lost : TrackingStatus::Relocalised) << result.reason;
    ASSERT_TRUE(result.fit);
    EXPECT_LT(result.fit->observed_ratio, 0.5);
    EXPECT_LT(errorAt(i, result.fit->world_from_camera, sequence), 0.02) << "frame " << i;
    EXPECT_FALSE(result.fused);
    // Then the nine before are known as well.
    ASSERT_EQ(result.recovered.size(), i < kTold ? 0 : kTold - kFound);
    for (std::size_t k = 0; k < result.recovered.size(); ++k)
      EXPECT_LT(errorAt(kFound + k, result.recovered[k].pose.world_from_camera, sequence), 0.02);
  }
}

// 22 cm beside its place a little more of the view fits, but what the camera should see there is missing.
TEST_F(FrameByFrame, AWallIsNotTakenForTheWindowsPaneBesideIt) {
  const SynthSequence sequence = makeShortSequence(kRoomWithPaneLikeWall, 240);
  Pipeline pipeline(device(), loadSettings("default"), sequence.intrinsics, sequence.depth_units_per_metre);
  constexpr std::size_t kFound = 190;
  showThenDarken(pipeline, sequence, 120);
  EXPECT_EQ(pipeline.processFrame(sequence.frames[kFound]).status, TrackingStatus::Lost);
  const FrameResult result = pipeline.processFrame(sequence.frames[kFound + 1]);
  EXPECT_EQ(result.status, TrackingStatus::Relocalised) << result.reason;
  EXPECT_LT(errorAt(kFound + 1, result.world_from_camera, sequence), 0.02);
}

TEST_F(FrameByFrame, AHandBeforeTheCameraIsNotFused) {
  const SynthSequence sequence = makeShortSequence(kRoomFlownFast, 24);
  Pipeline pipeline(device(), loadSettings("default"), sequence.intrinsics, sequence.depth_units_per_metre);
  VolumeContents before;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    Frame frame = sequence.frames[i];
    const bool hand = i >= 12 && i < 18;
    if (i == 12) before = pipeline.volume().download();
    if (i == 18) {
      EXPECT_EQ(pipeline.volume().download().weight, before.weight);
    }
    if (hand) {
      frame.depth = frame.depth.clone();
      frame.depth(cv::Rect(0, 0, frame.depth.cols / 2, frame.depth.rows))
          .setTo(static_cast<int>(0.35 * sequence.depth_units_per_metre));
    }
    const FrameResult result = pipeline.processFrame(frame);
    if (hand) {
      EXPECT_NE(result.status, TrackingStatus::Tracked) << "frame " << i;
    }
    if (result.status == TrackingStatus::Lost) continue;
    EXPECT_EQ(result.fused, !hand && result.status != TrackingStatus::Relocalised) << "frame " << i;
    EXPECT_LT(errorAt(i, result.world_from_camera, sequence), 0.03) << "frame " << i << ": " << result.reason;
    if (i + 1 == sequence.frames.size()) {
      EXPECT_EQ(result.status, TrackingStatus::Tracked) << result.reason;
    }
  }
}

// Half a metre from one frame to the next, which no motion model can guess.
TEST_F(FrameByFrame, AJumpIsFusedOnlyWithOdometry) {
  const SynthSequence sequence = makeShortSequence(kRoomFlownFast, 23);
  const auto& truth = sequence.truth;
  constexpr std::size_t kBefore = 9, kAfter = 19;
  const Pose jump = truth[kBefore].world_from_camera.inverse() * truth[kAfter].world_from_camera;
  ASSERT_GT(jump.translation().norm(), 0.5);
  struct Told {
    bool rotation, translation;
  };
  for (const Told told : {Told{true, true}, Told{true, false}, Told{false, false}}) {
    SCOPED_TRACE(told.translation ? "all told" : told.rotation ? "the rotation told" : "nothing told");
    Pipeline pipeline(device(), loadSettings("default"), sequence.intrinsics, sequence.depth_units_per_metre);
    std::size_t last = 0;
    for (std::size_t i = 0; i < sequence.frames.size(); i = i == kBefore ? kAfter : i + 1) {
      Frame frame = sequence.frames[i];
      if (told.rotation)
        frame.motion = CameraMotion{truth[last].world_from_camera.inverse() * truth[i].world_from_camera,
                                    told.translation};
      const FrameResult result = pipeline.processFrame(frame);
      last = i;
      // A rotation alone leaves half a metre to be found: it may be, or the frame is lost.
      if (told.translation || i <= kBefore) {
        EXPECT_NE(result.status, TrackingStatus::Lost) << "frame " << i << ": " << result.reason;
      }
      if (result.status != TrackingStatus::Lost) {
        EXPECT_LT(errorAt(i, result.world_from_camera, sequence), 0.03) << "frame " << i;
      }
    }
  }
}

/// What a camera at `world_from_camera` sees of the plan's scene, without noise.
Frame frameFrom(const SynthPlan& plan, const Pose& world_from_camera, double timestamp) {
  Frame frame;
  frame.timestamp = timestamp;
  renderDepth(plan.tracer(), plan.options().intrinsics, world_from_camera)
      .convertTo(frame.depth, CV_16UC1, kSynthDepthUnitsPerMetre);
  return frame;
}

// Further away and further turned than any search around a known pose reaches.
TEST_F(FrameByFrame, ALostCameraIsFoundAgainFromElsewhere) {
  for (const std::uint64_t seed : kRoomsToLookAroundIn) {
    SCOPED_TRACE(seed);
    SynthOptions options;
    options.seed = seed;
    options.frames = 2;
    options.intrinsics = {320, 240, 160, 160, 159.5, 119.5};
    const SynthPlan plan(options);
    Pipeline pipeline(device(), loadSettings("default"), options.intrinsics, kSynthDepthUnitsPerMetre);
    const Pose world = plan.truth()[0].world_from_camera;
    const auto turned = [&](double yaw, double roll) {
      Pose out = world;
      out.linear() = world.linear() * (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()) *
                                       Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
                                          .toRotationMatrix();
      return out;
    };
    double seconds = 0;
    for (double yaw = -0.8; yaw < 0.81; yaw += 0.1, seconds += 0.03)
      pipeline.fuseFrame(frameFrom(plan, turned(yaw, 0), seconds), world.inverse() * turned(yaw, 0));
    // To where there is most room.
    Pose elsewhere = turned(0, 0.6);
    double most = 0;
    for (const double angle : {0.0, 1.57, 3.14, 4.71}) {
      const Eigen::Vector3d there = world * Eigen::Vector3d(1.2 * std::sin(angle), 0, 1.2 * std::cos(angle));
      const double room = plan.tracer().clearance(there, 2);
      if (room > most) elsewhere.translation() = there;
      most = std::max(most, room);
    }
    ASSERT_GT(most, 0.3);
    Frame nothing = frameFrom(plan, world, seconds += 0.03);
    nothing.depth.setTo(0);
    ASSERT_EQ(pipeline.processFrame(nothing).status, TrackingStatus::Lost);
    const auto before = pipeline.volume().download().weight;
    FrameResult result;
    for (int i = 0; i < 5 && result.status == TrackingStatus::Lost; ++i)
      result = pipeline.processFrame(frameFrom(plan, elsewhere, seconds += 0.03));
    ASSERT_EQ(result.status, TrackingStatus::Relocalised) << result.reason;
    EXPECT_LT((world * result.world_from_camera.translation() - elsewhere.translation()).norm(), 0.02);
    EXPECT_EQ(pipeline.volume().download().weight, before);
  }
}

// As before a hand that fits a wall elsewhere. No camera turns so far between two frames, but a sensor says
// so.
TEST_F(FrameByFrame, ASuddenlyUnknownViewMustBeConfirmed) {
  SynthOptions options;
  options.seed = kRoomToTurnIn;
  options.frames = 2;
  options.intrinsics = {320, 240, 160, 160, 159.5, 119.5};
  const SynthPlan plan(options);
  const Pose world = plan.truth()[0].world_from_camera;
  for (const double turn : {0.25, 0.65}) {
    SCOPED_TRACE(turn);
    const CameraMotion motion{Pose(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY())), true};
    Pipeline pipeline(device(), loadSettings("default"), options.intrinsics, kSynthDepthUnitsPerMetre);
    for (int i = 0; i < 4; ++i) {
      Frame frame = frameFrom(plan, world, 0.03 * i);
      frame.motion = CameraMotion{Pose::Identity(), true};
      ASSERT_TRUE(pipeline.processFrame(frame).fused);
    }
    Frame frame = frameFrom(plan, world * motion.last_camera_from_camera, 0.12);
    frame.motion = motion;
    const FrameResult result = pipeline.processFrame(frame);
    ASSERT_TRUE(result.fit);
    EXPECT_LT((result.world_from_camera.translation()).norm(), 0.02);
    EXPECT_EQ(result.status, turn < 0.5 ? TrackingStatus::Tracked : TrackingStatus::Relocalised)
        << result.fit->observed_ratio << " " << result.reason;
  }
}

TEST_F(FrameByFrame, FramesFromAnotherRoomAreLostAndNotFused) {
  const SynthSequence sequence = makeShortSequence(kSmallRoom, 8), other = makeShortSequence(kForeignRoom, 4);
  Pipeline pipeline(device(), loadSettings("default"), sequence.intrinsics, sequence.depth_units_per_metre);
  for (const Frame& frame : sequence.frames) pipeline.processFrame(frame);
  const auto before = pipeline.volume().download();
  for (const Frame& frame : other.frames)
    EXPECT_EQ(pipeline.processFrame(frame).status, TrackingStatus::Lost);
  EXPECT_EQ(pipeline.volume().download().weight, before.weight);
}

TEST_F(FrameByFrame, FrameWithoutDepthIsLostAndNotFused) {
  Pipeline pipeline = make();
  pipeline.processFrame(shortSequence().frames[0]);
  const auto before = pipeline.volume().download();
  Frame empty = shortSequence().frames[1];
  empty.depth = cv::Mat(empty.depth.size(), CV_16UC1, cv::Scalar(0));
  const FrameResult result = pipeline.processFrame(empty);
  EXPECT_EQ(result.status, TrackingStatus::Lost);
  EXPECT_EQ(result.reason, Reason::LittleDepth);
  EXPECT_EQ(pipeline.volume().download().weight, before.weight);
  EXPECT_FALSE(result.number);
  EXPECT_EQ(pipeline.trajectory().size(), 1u);
  const FrameResult next = pipeline.processFrame(shortSequence().frames[1]);
  EXPECT_NE(next.status, TrackingStatus::Lost) << "the next good frame resumes";
  ASSERT_EQ(next.number, 1u);
  EXPECT_EQ(pipeline.trajectory()[1].world_from_camera.matrix(), next.world_from_camera.matrix());
}

TEST_F(FrameByFrame, FirstFrameWithoutDepthStartsNothing) {
  Pipeline pipeline = make();
  Frame empty = shortSequence().frames[0];
  empty.depth = cv::Mat(empty.depth.size(), CV_16UC1, cv::Scalar(0));
  EXPECT_EQ(pipeline.processFrame(empty).status, TrackingStatus::Lost);
  EXPECT_EQ(pipeline.volume().blockCount(), 0u);
  EXPECT_EQ(pipeline.processFrame(shortSequence().frames[0]).status, TrackingStatus::Tracked);
}

TEST_F(FrameByFrame, FrameFromElsewhereIsLost) {
  Pipeline pipeline = make();
  pipeline.processFrame(shortSequence().frames[0]);
  Frame wall = shortSequence().frames[1];  // a wall at 30 cm, where the model has free space
  wall.depth = cv::Mat(wall.depth.size(), CV_16UC1, cv::Scalar(1500));
  const FrameResult result = pipeline.processFrame(wall);
  EXPECT_EQ(result.status, TrackingStatus::Lost) << result.score.residual;
  EXPECT_EQ(result.reason, Reason::PoorFit);
}

TEST_F(FrameByFrame, SameSeedGivesTheSamePosesBitByBit) {
  Pipeline first = make(), second = make();
  Settings other_seed = quickSettings();
  other_seed.tracking.seed = 2;
  Pipeline third = make(other_seed);
  bool differs = false;
  for (std::size_t i = 0; i < 6; ++i) {
    const Frame& frame = shortSequence().frames[i];
    const auto a = first.processFrame(frame), b = second.processFrame(frame), c = third.processFrame(frame);
    EXPECT_EQ(a.world_from_camera.matrix(), b.world_from_camera.matrix()) << "frame " << i;
    differs = differs || a.world_from_camera.matrix() != c.world_from_camera.matrix();
  }
  EXPECT_TRUE(differs) << "another seed must search elsewhere, or the comparison shows nothing";
}

TEST_F(FrameByFrame, WrongImageSizeAndTypeAreRefused) {
  Pipeline pipeline = make();
  Frame frame = shortSequence().frames[0];
  frame.depth = cv::Mat::ones(10, 10, CV_16UC1);
  EXPECT_THROW(pipeline.processFrame(frame), InputError);
  frame.depth = cv::Mat::ones(shortSequence().frames[0].depth.size(), CV_8UC1);
  EXPECT_THROW(pipeline.processFrame(frame), InputError);
}

TEST_F(FrameByFrame, FullMemoryKeepsTheModel) {
  Settings small = quickSettings();
  small.volume.memory_limit_mb = 17;  // the first pools and table fit, the house does not
  small.volume.voxel_size = 0.01;
  small.volume.truncation = 0.03;
  Pipeline pipeline = make(small);
  const auto fuse_all = [&] {
    for (const Frame& frame : shortSequence().frames) pipeline.processFrame(frame);
  };
  EXPECT_TRUE(throwsDeviceError(fuse_all, DeviceErrorCode::OutOfMemory, {"volume.voxel_size"}));
  EXPECT_NO_THROW(pipeline.volume().download());
}

}  // namespace test_pipeline
}  // namespace rosefusion::testing
