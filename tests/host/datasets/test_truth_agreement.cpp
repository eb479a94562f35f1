// Truth and depth that do not belong together are told apart: scale, order of a quaternion, direction of a
// pose.
#include "host/datasets/truth_agreement.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "host/datasets/inspection.h"

namespace rosefusion::testing {
namespace test_truth_agreement {

using ::testing::HasSubstr;

constexpr int kImageWidth = 96, kImageHeight = 72;
const Intrinsics kCamera{kImageWidth, kImageHeight, 60, 60, 47.5, 35.5};

/// A camera that moves and turns in a box of 4 x 3 x 5 m.
class BoxSequence : public Sequence {
 public:
  explicit BoxSequence(double units) : units_(units) {
    info_.format = "TUM RGB-D";
    info_.intrinsics = kCamera;
    info_.depth_units_per_metre = units;
    info_.frames = 40;
    for (std::size_t i = 0; i < info_.frames; ++i) info_.truth.push_back({timestamp(i), poseAt(i)});
  }
  SequenceInfo& info() { return info_; }
  double timestamp(std::size_t index) const override { return static_cast<double>(index) / 30; }
  Pose poseAt(std::size_t i) const {
    const double t = static_cast<double>(i);
    Pose pose = Pose::Identity();
    pose.linear() = (Eigen::AngleAxisd(0.3 + 0.01 * t, Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(0.2 - 0.008 * t, Eigen::Vector3d::UnitX()))
                        .toRotationMatrix();
    pose.translation() = Eigen::Vector3d(0.02 * t, 0.3 * std::sin(0.05 * t), -0.015 * t);
    return pose;
  }
  bool read(std::size_t index, Frame& frame, std::string&) override {
    frame = {};
    frame.timestamp = timestamp(index);
    frame.depth = cv::Mat(kImageHeight, kImageWidth, CV_16UC1);
    const Pose pose = poseAt(index);
    for (int v = 0; v < kImageHeight; ++v)
      for (int u = 0; u < kImageWidth; ++u) {
        const Eigen::Vector3d ray = pose.linear() * kCamera.unproject(u, v, 1), from = pose.translation();
        const Eigen::Vector3d half(2, 1.5, 2.5);
        double z = 1e9;  // along the optical axis
        for (int k = 0; k < 3; ++k) z = std::min(z, ((ray[k] > 0 ? half[k] : -half[k]) - from[k]) / ray[k]);
        frame.depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(std::lround(z * units_));
      }
    return true;
  }

 private:
  double units_;
};

TEST(TruthAgreement, AgreesAsItIs) {
  BoxSequence sequence(5000);
  const TruthCheck check = checkTruth(sequence);
  EXPECT_TRUE(check.agrees);
  EXPECT_FALSE(check.doubt);
  const Inspection inspection = inspectSequence(sequence);
  for (const Finding& finding : inspection.findings) EXPECT_EQ(finding.what, "");
}

TEST(TruthAgreement, AWrongScaleIsNamedWithTheRightOne) {
  for (const double real : {1000.0, 10000.0}) {
    BoxSequence sequence(real);
    sequence.info().depth_units_per_metre = 5000;
    const TruthCheck check = checkTruth(sequence);
    ASSERT_TRUE(check.doubt) << real;
    EXPECT_THAT(check.doubt->remedy, HasSubstr(real == 1000 ? "1000" : "10000"));
    EXPECT_GT(check.doubt->other_agreement, 0.8);
  }
}

TEST(TruthAgreement, PosesWrittenInAnotherWayAreNamed) {
  const struct {
    std::function<Pose(const Pose&)> written;
    const char* says;
  } cases[] = {{[](const Pose& p) {
                  const Eigen::Quaterniond q(p.linear());
                  Pose out = p;  // w x y z, read as x y z w
                  out.linear() = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
                  return out;
                },
                "w first"},
               {[](const Pose& p) { return p.inverse(); }, "from the world to the camera"},
               {[](const Pose& p) {
                  Pose out = p;
                  out.linear() *= Eigen::DiagonalMatrix<double, 3>(1, -1, -1);
                  return out;
                },
                "y up"}};
  for (const auto& c : cases) {
    BoxSequence sequence(5000);
    for (StampedPose& pose : sequence.info().truth)
      pose.world_from_camera = c.written(pose.world_from_camera);
    const TruthCheck check = checkTruth(sequence);
    ASSERT_TRUE(check.doubt) << c.says;
    EXPECT_THAT(check.doubt->reading, HasSubstr(c.says));
  }
}

TEST(TruthAgreement, SaysNothingWithoutTruthOrMotion) {
  BoxSequence sequence(1000);
  sequence.info().depth_units_per_metre = 5000;
  sequence.info().truth.clear();
  EXPECT_FALSE(checkTruth(sequence).doubt);
  for (std::size_t i = 0; i < sequence.size(); ++i)
    sequence.info().truth.push_back({sequence.timestamp(i), sequence.poseAt(0)});
  EXPECT_FALSE(checkTruth(sequence).doubt);
  EXPECT_FALSE(checkTruth(sequence).agrees);
}

}  // namespace test_truth_agreement
}  // namespace rosefusion::testing
