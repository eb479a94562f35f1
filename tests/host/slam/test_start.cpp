// A first image that is not worth building on does not cost the frames that follow.
#include <opencv2/core.hpp>

#include "host/slam/pipeline.h"
#include "tests/engine/validating_device.h"
#include "tests/host/slam/short_sequence.h"

namespace rosefusion::testing {
namespace test_start {

struct Spoilt {
  const char* name;
  void (*spoil)(cv::Mat& depth);
};

class Start : public ValidatingDevice, public ::testing::WithParamInterface<Spoilt> {
 protected:
  static void SetUpTestSuite() { sequence_ = makeShortSequence(kRoomWithoutWindows, 12); }
  static Pipeline make() {
    return {device(), loadSettings("default"), sequence_.intrinsics, sequence_.depth_units_per_metre};
  }
  static inline SynthSequence sequence_;
};

// Half of it empty, a hand at 25 cm before most of it, all but some columns beyond the sensor's reach.
TEST_P(Start, ASpoiltFirstImageCostsThreeFramesAtMost) {
  Pipeline pipeline = make();
  Frame first = sequence_.frames[0];
  first.depth = first.depth.clone();
  GetParam().spoil(first.depth);
  std::size_t began = 0;
  int lost = 0;
  for (std::size_t i = 0; i < sequence_.frames.size(); ++i) {
    const FrameResult result = pipeline.processFrame(i == 0 ? first : sequence_.frames[i]);
    if (result.began_anew) began = i - 1, lost = static_cast<int>(began);
    if (result.status == TrackingStatus::Lost) {
      ++lost;
      continue;
    }
    const Pose truth =
        sequence_.truth[began].world_from_camera.inverse() * sequence_.truth[i].world_from_camera;
    if (i > 3) {
      EXPECT_LT((truth.translation() - result.world_from_camera.translation()).norm(), 0.03) << "frame " << i;
    }
  }
  EXPECT_LE(lost, 3);
}

INSTANTIATE_TEST_SUITE_P(
    FirstImages, Start,
    ::testing::Values(Spoilt{"HalfEmpty", [](cv::Mat& d) { d.colRange(d.cols / 2, d.cols) = 0; }},
                      Spoilt{"Hand", [](cv::Mat& d) { d.colRange(d.cols / 3, d.cols) = 1250; }},
                      Spoilt{"FewPercent", [](cv::Mat& d) { d.rowRange(d.rows / 16, d.rows) = 0; }},
                      Spoilt{"OutOfRange", [](cv::Mat& d) { d = 65535; }}),
    [](const ::testing::TestParamInfo<Spoilt>& spoilt) { return std::string(spoilt.param.name); });

// What comes before the camera for two frames after a good first one is not what the model begins with.
TEST_F(Start, AGoodFirstImageStays) {
  Pipeline pipeline = make();
  const auto run = [&](const cv::Mat& depth, std::size_t i) {
    Frame frame = sequence_.frames[i];
    frame.depth = depth;
    return pipeline.processFrame(frame);
  };
  run(sequence_.frames[0].depth, 0);
  for (std::size_t i = 1; i < 3; ++i) {
    cv::Mat noise(sequence_.frames[0].depth.size(), CV_16UC1);
    cv::theRNG().state = i;
    cv::randu(noise, 2000, 20000);
    EXPECT_FALSE(run(noise, i).began_anew);
  }
  FrameResult last;
  for (std::size_t i = 1; i < 5; ++i) last = run(sequence_.frames[i].depth, i + 2);
  EXPECT_NE(last.status, TrackingStatus::Lost) << last.reason;
  EXPECT_LT(errorAt(4, last.world_from_camera, sequence_), 0.03);
}

// Poses that were told keep their numbers where the model is tried anew with what follows, and stays.
TEST_F(Start, PosesOfAModelThatStaysAreKept) {
  Pipeline pipeline = make();
  for (std::size_t i = 0; i < 2; ++i) {
    Frame frame = sequence_.frames[i];
    frame.depth = frame.depth.clone();
    if (i == 1) frame.depth.rowRange(frame.depth.rows / 3, frame.depth.rows) = 0;  // confirms a third of it
    EXPECT_EQ(pipeline.processFrame(frame).number, i);
  }
  // Two other rooms, which fit neither it nor each other, and show more than has confirmed it.
  for (std::size_t i = 2; i < 4; ++i) {
    Frame frame = sequence_.frames[i];
    frame.depth = makeShortSequence(i == 2 ? kUnlikeRoom : kThirdRoom, 2).frames[0].depth;
    frame.depth.rowRange(0, frame.depth.rows / 4) = 0;
    const FrameResult result = pipeline.processFrame(frame);
    EXPECT_EQ(result.status, TrackingStatus::Lost);
    EXPECT_FALSE(result.began_anew);
  }
  EXPECT_EQ(pipeline.trajectory().size(), 2u);
}

}  // namespace test_start
}  // namespace rosefusion::testing
