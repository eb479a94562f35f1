// Pass icp against its reference, on a model cast from the fused scene.
#include <functional>

#include "engine/passes/icp.h"
#include "tests/engine/scene_run.h"
#include "tests/engine/validating_device.h"
#include "tests/reference/icp.h"
#include "tests/reference/packed_surface.h"

namespace rosefusion::testing {
namespace test_icp {

constexpr VolumeOptions kVolume{.voxel_size = 0.04f, .truncation = 0.12f};
constexpr int kFrames = 3;
constexpr IcpPairing kPairing{.stride = 2, .distance = 0.125f, .cosine = 0.875f};
// Of the sums: where rounding decides about so many pairs that the range tells little.
constexpr double kWideShare = 0.1;

class PointToPlane : public ValidatingDevice, public ::testing::WithParamInterface<Intrinsics> {
 protected:
  void SetUp() override {
    ValidatingDevice::SetUp();
    if (HasFatalFailure()) return;
    run_.emplace(device(), makeSequence(GetParam(), kFrames, 71), kVolume);
    run_->fuse(0);
    run_->fuse(1);
    run_->load(2);
    const glm::mat4 model_pose = onDevice(run_->sequence.poses[1]);
    raycast_.emplace(device(), onDevice(GetParam()));
    raycast_->record(run_->recorder, run_->volume, {.world_from_camera = model_pose, .colour = false});
    run_->recorder.submit();
    const std::size_t pixels = std::size_t(GetParam().width) * GetParam().height;
    model_.camera = GetParam();
    model_.world_from_camera = asFloats(run_->sequence.poses[1]);
    const auto words = readBack<std::uint32_t>(device(), raycast_->surface(), 2 * pixels);
    for (std::size_t i = 0; i < words.size(); i += 2)
      model_.surface.push_back(reference::unpackedSurface(words[i], words[i + 1]));
    model_.stride = kPairing.stride;
    model_.offset = kPairing.stride / 2;
    model_.distance = kPairing.distance;
    model_.cosine = kPairing.cosine;
    points_ = inDoubles(run_->preprocess.frame().points, pixels);
    pose_ = asFloats(run_->sequence.poses[2]);
  }

  static Pose asFloats(const Pose& pose) {
    Pose out = pose;
    out.matrix() = pose.matrix().cast<float>().cast<double>();
    return out;
  }
  std::vector<Eigen::Vector4d> inDoubles(const Buffer& buffer, std::size_t pixels) {
    std::vector<Eigen::Vector4d> out;
    for (const glm::vec4& v : readBack<glm::vec4>(device(), buffer, pixels))
      out.emplace_back(v.x, v.y, v.z, v.w);
    return out;
  }
  std::vector<double> sums() {
    IcpPass pass(device(), onDevice(GetParam()));
    pass.record(run_->recorder, run_->preprocess.frame(), *raycast_,
                onDevice(model_.world_from_camera.inverse()), kPairing, onDevice(pose_));
    run_->recorder.submit();
    const IcpSums sums = pass.sums();
    return {sums.begin(), sums.end()};
  }
  reference::Comparison compareWith(const std::vector<double>& measured,
                                    const reference::IcpModel& model) const {
    return compare(icpSums(model, points_, pose_), measured);
  }

  std::optional<SceneRun> run_;
  std::optional<RaycastPass> raycast_;
  reference::IcpModel model_;
  std::vector<Eigen::Vector4d> points_;
  Pose pose_;
};

TEST_P(PointToPlane, AgreesWithTheReferenceAtSeveralPoses) {
  const Pose truth = pose_;
  double at_truth = 0;  // mean square
  for (const double off : {0.0, 0.3, -0.7, 1.5}) {
    pose_ = truth;
    pose_.translation() += off * Eigen::Vector3d(0.02, -0.03, 0.025);
    pose_.rotate(Eigen::AngleAxisd(off * 0.03, Eigen::Vector3d(1, 2, -1).normalized()));
    pose_ = asFloats(pose_);
    const auto measured = sums();
    EXPECT_TRUE(agrees(compareWith(measured, model_), kWideShare)) << "off by " << off;
    EXPECT_GT(measured[shader::kIcpPairs], 300) << "off by " << off;
    const double mean_square = measured[shader::kIcpSquares] / measured[shader::kIcpPairs];
    if (off == 0) at_truth = mean_square;
    EXPECT_GE(mean_square, at_truth) << "off by " << off;
  }
}

TEST_P(PointToPlane, ComparisonSeesAWrongCoefficient) {
  const auto measured = sums();
  ASSERT_TRUE(agrees(compareWith(measured, model_), kWideShare));
  const auto wrong = [&](const std::function<void(reference::IcpModel&)>& change) {
    reference::IcpModel model = model_;
    change(model);
    return compareWith(measured, model);
  };
  EXPECT_TRUE(differs(wrong([](auto& m) { m.distance *= 0.9; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.cosine += 0.02; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.reach = 3; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.offset = 0; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.turn_sense = -1; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.camera.cx += 0.5; })));
  EXPECT_TRUE(differs(wrong([](auto& m) { m.world_from_camera.translation().x() += 0.01; })));
  pose_.translation().y() += 0.001;
  EXPECT_TRUE(differs(compareWith(measured, model_)));
}

TEST_P(PointToPlane, AnEmptyModelHasNoPairs) {
  SceneRun empty(device(), run_->sequence, kVolume);
  raycast_->record(run_->recorder, empty.volume, {.world_from_camera = onDevice(pose_), .colour = false});
  run_->recorder.submit();
  for (const double sum : sums()) EXPECT_EQ(sum, 0);
}

INSTANTIATE_TEST_SUITE_P(Cameras, PointToPlane, kBothCameras, cameraName);

}  // namespace test_icp
}  // namespace rosefusion::testing
