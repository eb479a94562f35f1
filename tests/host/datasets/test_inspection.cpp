// The figures of an inspection against values worked out by hand, and one sequence per thing that can look
// wrong.
#include "host/datasets/inspection.h"

#include <gmock/gmock.h>

#include <functional>

#include "tests/host/datasets/fixtures.h"

namespace rosefusion::testing {
namespace test_inspection {

using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Frames made by a function instead of files.
class MadeSequence : public Sequence {
 public:
  MadeSequence(std::size_t frames, std::function<cv::Mat(std::size_t)> depth) : depth_(std::move(depth)) {
    info_.frames = frames;
    info_.depth_units_per_metre = 1000;
    info_.intrinsics = {kWidth, kHeight, 30, 30, 15.5, 11.5};
    for (std::size_t i = 0; i < frames; ++i) stamps.push_back(static_cast<double>(i) / 30);
  }
  SequenceInfo& info() { return info_; }
  double timestamp(std::size_t index) const override { return stamps[index]; }
  bool read(std::size_t index, Frame& frame, std::string& problem) override {
    frame = {stamps[index], depth_(index), {}};
    problem = frame.depth.empty() ? "frame.png: the file is missing." : colour_problem;
    return !frame.depth.empty();
  }
  std::vector<double> stamps;
  std::string colour_problem;

 private:
  std::function<cv::Mat(std::size_t)> depth_;
};

cv::Mat ramp(std::size_t index) {
  return depthImage(1500 + static_cast<int>(index));
}

auto says(bool fatal, const std::string& text) {
  return Contains(AllOf(Field(&Finding::fatal, fatal), Field(&Finding::what, HasSubstr(text))));
}

TEST(Inspection, AGoodSequenceHasNothingWrong) {
  MadeSequence sequence(60, ramp);
  const Inspection r = inspectSequence(sequence);
  EXPECT_THAT(r.findings, IsEmpty());
  EXPECT_TRUE(r.usable());
  EXPECT_EQ(r.images_read, 60u);
  EXPECT_NEAR(r.seconds, 59 / 30.0, 1e-9);
  EXPECT_NEAR(r.frames_per_second, 30, 1e-6);
  EXPECT_FALSE(r.speeds);
}

TEST(Inspection, SharesAndPercentilesAreExact) {
  // 768 pixels: frame 0 all at 1 m; frame 1 half at 3 m, a quarter invalid as 0, a quarter as 65535.
  MadeSequence sequence(2, [](std::size_t index) {
    cv::Mat depth(kHeight, kWidth, CV_16UC1, cv::Scalar(1000));
    if (index == 1) {
      depth.rowRange(0, 12) = 3000;
      depth.rowRange(12, 18) = 0;
      depth.rowRange(18, 24) = 65535;
    }
    return depth;
  });
  const Inspection r = inspectSequence(sequence);
  EXPECT_DOUBLE_EQ(r.valid_share_worst, 0.5);
  EXPECT_EQ(r.worst_frame, 1u);
  EXPECT_EQ(r.flat_frames, 2u);
  ASSERT_TRUE(r.depth);
  EXPECT_DOUBLE_EQ(r.depth->p1, 1);
  EXPECT_DOUBLE_EQ(r.depth->p50, 1);
  EXPECT_DOUBLE_EQ(r.depth->p95, 3);
}

TEST(Inspection, SpeedsFollowTruthAndStampUnit) {
  for (const double unit : {1.0, 1 / 30.0}) {  // seconds, and frame numbers at 30 Hz
    MadeSequence sequence(4, ramp);
    sequence.info().seconds_per_stamp = unit;
    for (std::size_t i = 0; i < 4; ++i) {
      sequence.stamps[i] = static_cast<double>(i) / 30 / unit;
      StampedPose p{sequence.stamps[i]};
      p.world_from_camera.translation().x() = i == 3 ? 0.09 : 0.02 * static_cast<double>(i);
      p.world_from_camera.linear() =
          Eigen::AngleAxisd(0.01 * static_cast<double>(i), Eigen::Vector3d::UnitY()).matrix();
      sequence.info().truth.push_back(p);
    }
    const Inspection r = inspectSequence(sequence);
    EXPECT_EQ(r.frames_with_truth, 4u);
    ASSERT_TRUE(r.speeds);
    EXPECT_NEAR(r.speeds->linear_mean, 0.9, 1e-9);  // 0.09 m in 0.1 s
    EXPECT_NEAR(r.speeds->linear_max, 1.5, 1e-9);
    EXPECT_NEAR(r.speeds->angular_mean, 0.3, 1e-9);
    EXPECT_NEAR(r.frames_per_second, 30, 1e-9);
    EXPECT_THAT(r.findings, IsEmpty());
  }
}

TEST(Inspection, LimitedImagesAreSpreadOverTheSequence) {
  std::vector<std::size_t> looked_at;
  MadeSequence sequence(100, [&](std::size_t index) {
    looked_at.push_back(index);
    return ramp(index);
  });
  std::size_t last_done = 0;
  const Inspection r = inspectSequence(sequence, 4, [&](std::size_t done, std::size_t) { last_done = done; });
  EXPECT_THAT(looked_at, ::testing::ElementsAre(0, 25, 50, 75));
  EXPECT_EQ(last_done, 4u);
  EXPECT_EQ(r.images_read, 4u);
  EXPECT_TRUE(inspectSequence(sequence, 1).usable())
      << "looking at one image only is no defect of the sequence";
}

TEST(Findings, SuspiciousDepthScaleSuggestsAnother) {
  MadeSequence sequence(10, ramp);
  sequence.info().depth_units_per_metre = 50000;
  const Inspection small = inspectSequence(sequence);
  EXPECT_THAT(small.findings, says(true, "depth scale"));
  EXPECT_THAT(small.findings[0].remedy, HasSubstr("1000 (millimetres)"));
  EXPECT_FALSE(small.usable());
  sequence.info().depth_units_per_metre = 10;
  EXPECT_THAT(inspectSequence(sequence).findings, says(true, "over"));
}

TEST(Findings, LowAndHopelessValidShare) {
  const auto withRows = [](int rows) {
    return MadeSequence(10, [rows](std::size_t index) {
      cv::Mat depth = ramp(index);
      depth.rowRange(rows, kHeight) = 0;
      return depth;
    });
  };
  MadeSequence low = withRows(5), hopeless = withRows(1), none = withRows(0);
  EXPECT_THAT(inspectSequence(low).findings, says(false, "under 20.8 %"));
  EXPECT_TRUE(inspectSequence(low).usable());
  EXPECT_THAT(inspectSequence(hopeless).findings, says(true, "under 4.2 %"));
  EXPECT_THAT(inspectSequence(none).findings, says(true, "not one pixel"));
}

TEST(Findings, ASingleEmptyFrameIsAWarning) {
  MadeSequence sequence(10, [](std::size_t index) {
    return index == 4 ? cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(0)) : ramp(index);
  });
  const Inspection r = inspectSequence(sequence);
  EXPECT_EQ(r.empty_frames, 1u);
  EXPECT_EQ(r.worst_frame, 4u);
  EXPECT_THAT(r.findings, says(false, "1 frame without any valid depth"));
  EXPECT_TRUE(r.usable());
}

TEST(Findings, FrozenCameraIsFatalAndSomeCopiesAWarning) {
  MadeSequence frozen(20, [](std::size_t) { return ramp(0); });
  EXPECT_THAT(inspectSequence(frozen).findings, says(true, "19 exact copies"));
  MadeSequence doubled(20, [](std::size_t index) { return ramp(index / 2); });
  EXPECT_THAT(inspectSequence(doubled).findings, says(false, "10 exact copies"));
}

TEST(Findings, FlatImagesAreNoDepth) {
  MadeSequence mask(20, [](std::size_t index) {
    return cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(1000 + static_cast<int>(index)));
  });
  EXPECT_THAT(inspectSequence(mask).findings, says(true, "20 frames with one and the same depth"));
}

TEST(Findings, UnreadableFrames) {
  MadeSequence few(20, [](std::size_t index) { return index == 7 ? cv::Mat() : ramp(index); });
  const Inspection r = inspectSequence(few);
  ASSERT_EQ(r.unreadable.size(), 1u);
  EXPECT_EQ(r.unreadable[0].index, 7u);
  EXPECT_THAT(r.findings, says(false, "1 of 20 depth images cannot be read; frame 7: frame.png"));
  MadeSequence most(20, [](std::size_t index) { return index > 3 ? cv::Mat() : ramp(index); });
  EXPECT_THAT(inspectSequence(most).findings, says(true, "16 of 20"));
  MadeSequence single(1, ramp);
  EXPECT_THAT(inspectSequence(single).findings, says(true, "only 1 depth image can"));
}

TEST(Findings, ColourThatCannotBeUsed) {
  MadeSequence sequence(10, ramp);
  sequence.colour_problem = "rgb.png: the image is 64x48, but this sequence is 32x24.";
  const Inspection r = inspectSequence(sequence);
  EXPECT_THAT(r.findings, says(false, "10 of 10 colour images cannot be used; frame 0: rgb.png"));
  EXPECT_TRUE(r.usable());
}

TEST(Findings, GapsDoubledStampsAndOddRates) {
  MadeSequence gap(20, ramp);
  for (std::size_t i = 10; i < 20; ++i) gap.stamps[i] += 0.5;
  const Inspection r = inspectSequence(gap);
  ASSERT_EQ(r.gaps.size(), 1u);
  EXPECT_EQ(r.gaps[0].after_frame, 9u);
  EXPECT_THAT(r.findings, says(false, "longest 0.53 s after frame 9"));
  MadeSequence doubled(20, ramp);
  doubled.stamps[5] = doubled.stamps[4];
  EXPECT_THAT(inspectSequence(doubled).findings, says(false, "1 frame with the same time stamp"));
  MadeSequence nanoseconds(20, ramp);
  for (double& stamp : nanoseconds.stamps) stamp *= 1e9;
  EXPECT_THAT(inspectSequence(nanoseconds).findings, says(false, "frames per second"));
}

TEST(Findings, TruthThatDoesNotMatchOrMovesTooFast) {
  MadeSequence other(20, ramp);
  for (int i = 0; i < 20; ++i) other.info().truth.push_back({1000.0 + i, Pose::Identity()});
  EXPECT_THAT(inspectSequence(other).findings, says(false, "covers 0 of 20 frames"));
  MadeSequence fast(20, ramp);
  for (std::size_t i = 0; i < 20; ++i) {
    fast.info().truth.push_back({fast.stamps[i], Pose::Identity()});
    fast.info().truth[i].world_from_camera.translation().x() = 0.2 * static_cast<double>(i);
  }
  EXPECT_THAT(inspectSequence(fast).findings, says(false, "6.0 m/s"));
}

TEST(Findings, AssumptionsAndWarningsArePassedOn) {
  MadeSequence sequence(20, ramp);
  sequence.info().intrinsics_assumed = true;
  sequence.info().warnings = {"depth.txt: 3 lines skipped."};
  const Inspection r = inspectSequence(sequence);
  EXPECT_THAT(r.findings, says(false, "intrinsics are assumed"));
  EXPECT_THAT(r.findings, says(false, "3 lines skipped"));
  EXPECT_TRUE(r.usable());
}

TEST(Findings, BytesInTheWrongOrderAreNamed) {
  MadeSequence sequence(5, [](std::size_t i) {
    cv::Mat image = depthImage(1500 + static_cast<int>(i), 64, 48);
    for (int v = 0; v < image.rows; ++v)
      for (int u = 0; u < image.cols; ++u) {
        std::uint16_t& value = image.at<std::uint16_t>(v, u);
        value = static_cast<std::uint16_t>(value << 8 | value >> 8);
      }
    return image;
  });
  sequence.info().depth_units_per_metre = 5000;  // the median is no reason
  EXPECT_THAT(inspectSequence(sequence).findings, says(true, "bytes of each value exchanged"));
}

TEST(Findings, DepthsOutsideWhatARunUsesAreNamed) {
  MadeSequence far(5, [](std::size_t i) { return depthImage(9000 + static_cast<int>(i)); });
  const Inspection r = inspectSequence(far);
  EXPECT_EQ(r.farther_share, 1);
  EXPECT_THAT(r.findings, says(true, "beyond depth.max (8 m)"));
  EXPECT_THAT(inspectSequence(far, 0, {}, {0.1, 20}).findings, IsEmpty());
  MadeSequence near(5, [](std::size_t i) { return depthImage(300 + static_cast<int>(i)); });
  EXPECT_THAT(inspectSequence(near, 0, {}, {1.0, 8}).findings, says(false, "nearer than depth.min (1 m)"));
}

TEST(Findings, AnAssumedScaleOfATinyRoomIsDoubted) {
  MadeSequence sequence(5, ramp);
  sequence.info().depth_units_per_metre = 5000;
  EXPECT_THAT(inspectSequence(sequence).findings, IsEmpty()) << "given";
  sequence.info().depth_units_assumed = true;
  EXPECT_THAT(inspectSequence(sequence).findings, says(false, "depth scale is assumed"));
}

TEST(Findings, IntrinsicsOfAnotherImageSize) {
  MadeSequence sequence(5, ramp);
  for (const auto& [cx, cy] : {std::pair{31.5, 23.5}, std::pair{7.5, 5.5}}) {
    sequence.info().intrinsics.cx = cx;
    sequence.info().intrinsics.cy = cy;
    EXPECT_THAT(inspectSequence(sequence).findings, says(false, "lies far from the middle")) << cx;
  }
  sequence.info().intrinsics = {kWidth, kHeight, 30, 21, 15.5, 11.5};
  EXPECT_THAT(inspectSequence(sequence).findings, says(false, "focal lengths"));
}

TEST(Findings, AnIncompleteStartIsTold) {
  MadeSequence sequence(10, [](std::size_t i) {
    cv::Mat image = ramp(i);
    if (i < 2) image.colRange(0, 2 * kWidth / 3) = 0;
    return image;
  });
  const Inspection r = inspectSequence(sequence);
  EXPECT_EQ(r.whole_from, 2u);
  EXPECT_THAT(r.findings, Contains(AllOf(Field(&Finding::kind, FindingKind::Start),
                                         Field(&Finding::remedy, HasSubstr("--start 2")))));
}

TEST(Findings, StampsWithoutDecimalsOrInAnotherUnit) {
  MadeSequence sequence(10, ramp);
  for (double& stamp : sequence.stamps) stamp = 1305031229;
  EXPECT_THAT(inspectSequence(sequence).findings,
              Contains(AllOf(Field(&Finding::what, HasSubstr("9 of 10 frames")),
                             Field(&Finding::remedy, HasSubstr("decimals were lost")))));
  for (std::size_t i = 0; i < 10; ++i) sequence.stamps[i] = 33e6 * static_cast<double>(i);
  EXPECT_THAT(inspectSequence(sequence).findings,
              Contains(Field(&Finding::remedy, HasSubstr("look like nanoseconds"))));
}

}  // namespace test_inspection
}  // namespace rosefusion::testing
