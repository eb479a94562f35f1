// Pass select_points against its reference: set, order and counts.
#include "tests/engine/scene_run.h"
#include "tests/engine/validating_device.h"
#include "tests/reference/select_points.h"

namespace rosefusion::testing {
namespace test_select_points {

// Points within rounding of the last frame's outline.
constexpr double kSkippedShare = 0.001;

class SelectPoints : public ValidatingDevice, public ::testing::WithParamInterface<Intrinsics> {
 protected:
  void SetUp() override {
    ValidatingDevice::SetUp();
    if (HasFatalFailure()) return;
    sequence_ = makeSequence(GetParam(), 4, 41);
    image_ = preprocess(sequence_.images[3].depth, GetParam(), sequence_.sensor);
    frame_.emplace(device(), onDevice(GetParam()));
    Recorder recorder(device());
    const auto& sensor = sequence_.sensor;
    frame_->record(recorder, sequence_.images[3].depth, sensor.metres_per_unit, sensor.min_depth,
                   sensor.max_depth);
    recorder.submit();
    // Three frames apart, so that a good part of the image is not in the overlap.
    previous_from_current_ = sequence_.poses[0].inverse() * sequence_.poses[3];
  }
  std::vector<float> select(SelectPointsPass& pass, const PixelGrid& grid, const Pose* motion) {
    Recorder recorder(device());
    const glm::mat4 matrix = motion ? onDevice(*motion) : glm::mat4(1);
    pass.record(recorder, frame_->frame(), grid, motion ? &matrix : nullptr);
    recorder.submit();
    return readBack<float>(device(), pass.points(), 4 * std::size_t(pass.selected()));
  }

  Sequence sequence_;
  reference::PointImage image_;
  std::optional<PreprocessPass> frame_;
  Pose previous_from_current_;
};

TEST_P(SelectPoints, AgreesWithTheReferenceOnEveryGrid) {
  // One pass object for all grids, so that a smaller one must not show the larger one's rest. A grid of fewer
  // cells than the workgroup has lanes, single rows and columns, and grids that end short of the image's edge
  // are among them.
  SelectPointsPass pass(device(), onDevice(GetParam()));
  // As GPUs do it: more parts than some grids have cells.
  SelectPointsPass by_seven(device(), onDevice(GetParam()), 7), by_many(device(), onDevice(GetParam()), 64);
  const PixelGrid grids[] = {{1, 0, 0},   {3, 2, 1},   {8, 5, 5},   {16, 10, 15},
                             {32, 20, 5}, {200, 7, 3}, {1, 159, 0}, {1, 0, 119}};
  for (const PixelGrid& grid : grids)
    for (const Pose* motion :
         {static_cast<const Pose*>(nullptr), static_cast<const Pose*>(&previous_from_current_)}) {
      SCOPED_TRACE("stride " + std::to_string(grid.stride) + (motion ? " with" : " without") +
                   " overlap test");
      const auto expected =
          selectPoints(image_, GetParam(), grid.stride, grid.offset_x, grid.offset_y, motion);
      const auto selected = select(pass, grid, motion);
      EXPECT_EQ(pass.valid(), expected.valid);
      EXPECT_TRUE(expected.points.empty() ? ::testing::AssertionResult(selected.empty())
                                          : agrees(compare(expected, selected), kSkippedShare));
      for (SelectPointsPass* other : {&by_seven, &by_many}) {
        EXPECT_EQ(select(*other, grid, motion), selected);
        EXPECT_EQ(other->valid(), pass.valid());
      }
    }
}

TEST_P(SelectPoints, TheOverlapLeavesSomeOut) {
  SelectPointsPass pass(device(), onDevice(GetParam()));
  select(pass, {1, 0, 0}, &previous_from_current_);
  EXPECT_GT(pass.selected(), pass.valid() / 4);
  EXPECT_LT(pass.selected(), pass.valid() * 95 / 100);
}

TEST_P(SelectPoints, PointsBehindTheLastCameraAreLeftOut) {
  SelectPointsPass pass(device(), onDevice(GetParam()));
  Pose half_turn = Pose::Identity();
  half_turn.linear() = Eigen::AngleAxisd(3.14159, Eigen::Vector3d::UnitY()).toRotationMatrix();
  select(pass, {1, 0, 0}, &half_turn);
  EXPECT_EQ(pass.selected(), 0u);
  EXPECT_GT(pass.valid(), 1000u);
}

TEST_P(SelectPoints, ComparisonSeesAWrongCoefficient) {
  SelectPointsPass pass(device(), onDevice(GetParam()));
  const auto selected = select(pass, {1, 0, 0}, &previous_from_current_);
  const auto compareWith = [&](const Intrinsics& camera, int stride, const Pose& motion) {
    return compare(selectPoints(image_, camera, stride, 0, 0, &motion), selected);
  };
  EXPECT_TRUE(agrees(compareWith(GetParam(), 1, previous_from_current_), kSkippedShare));
  Intrinsics camera = GetParam();
  camera.fx *= 1.002;
  EXPECT_TRUE(differs(compareWith(camera, 1, previous_from_current_)));
  camera = GetParam();
  camera.width -= 1;  // also the outline
  EXPECT_TRUE(differs(compareWith(camera, 1, previous_from_current_)));
  EXPECT_TRUE(differs(compareWith(GetParam(), 2, previous_from_current_)));
  Pose motion = previous_from_current_;
  motion.translation().x() += 0.002;
  EXPECT_TRUE(differs(compareWith(GetParam(), 1, motion)));
  EXPECT_TRUE(differs(compareWith(GetParam(), 1, previous_from_current_.inverse())));
}

TEST_P(SelectPoints, AGridOutsideTheImageIsAProgrammingError) {
  SelectPointsPass pass(device(), onDevice(GetParam()));
  for (const PixelGrid& grid :
       {PixelGrid{0, 0, 0}, PixelGrid{8, -1, 0}, PixelGrid{8, 0, 121}, PixelGrid{8, 161, 0}})
    EXPECT_TRUE(throwsDeviceError([&] { select(pass, grid, nullptr); }, DeviceErrorCode::Programming,
                                  {"pixel grid"}));
}

INSTANTIATE_TEST_SUITE_P(Cameras, SelectPoints, kBothCameras, cameraName);

}  // namespace test_select_points
}  // namespace rosefusion::testing
