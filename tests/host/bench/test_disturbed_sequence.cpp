// When the view that was known returns after a disturbance.
#include "host/bench/disturbed_sequence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace rosefusion::testing {
namespace test_disturbed_sequence {

constexpr std::size_t kFrames = 120, kDisturbed = 60, kAfter = kDisturbed + 10;  // black

/// A camera before an endless wall, which sees what it saw at first where it `isBack`.
class BeforeAWall : public Sequence {
 public:
  explicit BeforeAWall(const std::function<bool(std::size_t)>& isBack) {
    info_.intrinsics = {64, 48, 50, 50, 31.5, 23.5};
    info_.depth_units_per_metre = 1000;
    info_.frames = kFrames;
    for (std::size_t i = 0; i < kFrames; ++i) {
      Pose pose = Pose::Identity();
      if (i >= kAfter && !isBack(i)) pose.translation().x() = 20;
      info_.truth.push_back({timestamp(i), pose});
    }
  }
  double timestamp(std::size_t index) const override { return 0.1 * static_cast<double>(index); }
  bool read(std::size_t index, Frame& frame, std::string&) override {
    frame.timestamp = timestamp(index);
    frame.depth = cv::Mat(info_.intrinsics.height, info_.intrinsics.width, CV_16UC1, cv::Scalar(3000));
    return true;
  }
};

double returnsAt(const std::function<bool(std::size_t)>& isBack) {
  BeforeAWall whole(isBack);
  return DisturbedSequence(whole, Disturbance::Black).viewReturns() / 0.1;
}

TEST(DisturbedSequence, TheViewReturnsWhereItStays) {
  EXPECT_NEAR(returnsAt([](std::size_t) { return true; }), kAfter, 1e-6);
  EXPECT_NEAR(returnsAt([](std::size_t i) { return i >= 90; }), 90, 1e-6);
  EXPECT_NEAR(returnsAt([](std::size_t i) { return i < 75 || i >= 90; }), 90, 1e-6)
      << "what is gone at once leaves no time to be found";
  EXPECT_NEAR(returnsAt([](std::size_t i) { return i >= 72 && i < 72 + 15; }), 72, 1e-6);
}

TEST(DisturbedSequence, TheViewThatDoesNotStayNeverReturns) {
  EXPECT_TRUE(std::isinf(returnsAt([](std::size_t) { return false; })));
  EXPECT_TRUE(std::isinf(returnsAt([](std::size_t i) { return i % 15 != 0; })));
  EXPECT_TRUE(std::isinf(returnsAt([](std::size_t i) { return i >= kFrames - 14; })));
}

}  // namespace test_disturbed_sequence
}  // namespace rosefusion::testing
