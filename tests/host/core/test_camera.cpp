#include "host/core/camera.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/host/core/temporary_folder.h"

namespace rosefusion::testing {
namespace test_camera {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const Intrinsics kKinect{640, 480, 517.3, 516.5, 318.6, 255.3};

TEST(Intrinsics, ProjectUndoesUnproject) {
  for (const double fy : {516.5, -480.0}) {  // ICL-NUIM's is negative
    Intrinsics k = kKinect;
    k.fy = fy;
    const Eigen::Vector3d point = k.unproject(100, 400, 2.5);
    EXPECT_DOUBLE_EQ(point.z(), 2.5);
    EXPECT_NEAR((k.project(point) - Eigen::Vector2d(100, 400)).norm(), 0, 1e-10);
  }
}

TEST(Intrinsics, PrincipalPointLooksAlongTheAxis) {
  EXPECT_EQ(kKinect.unproject(318.6, 255.3, 3), Eigen::Vector3d(0, 0, 3));
  EXPECT_DOUBLE_EQ(kKinect.unproject(318.6 + 517.3, 255.3, 3).x(), 3);  // one focal length right: 45 degrees
}

TEST(RequirePlausible, AcceptsRealCameras) {
  EXPECT_NO_THROW(requirePlausible(kKinect, "kinect"));
  EXPECT_NO_THROW(requirePlausible({640, 480, 481.2, -480, 319.5, 239.5}, "icl"));
  EXPECT_NO_THROW(requirePlausible({1200, 680, 600, 600, 599.5, 339.5}, "replica"));
}

struct Implausible {
  const char* name;
  Intrinsics intrinsics;
  const char* reason;
};
void PrintTo(const Implausible& i, std::ostream* out) {
  *out << i.name;
}

class RejectsIntrinsics : public ::testing::TestWithParam<Implausible> {};

TEST_P(RejectsIntrinsics, WithTheReason) {
  const std::string sentence =
      inputErrorOf([] { requirePlausible(GetParam().intrinsics, "calibration.txt"); });
  EXPECT_THAT(sentence, AllOf(StartsWith("calibration.txt: "), HasSubstr(GetParam().reason)));
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
INSTANTIATE_TEST_SUITE_P(
    Camera, RejectsIntrinsics,
    ::testing::Values(Implausible{"AllZero", {640, 480, 0, 0, 0, 0}, "focal lengths"},
                      Implausible{"NegativeFx", {640, 480, -500, 500, 320, 240}, "focal lengths"},
                      Implausible{
                          "FocalLengthInMillimetres", {640, 480, 4.2, 4.2, 320, 240}, "focal lengths"},
                      Implausible{"FocalLengthFarTooLong", {640, 480, 50000, 500, 320, 240}, "focal lengths"},
                      Implausible{"FyZero", {640, 480, 500, 0, 320, 240}, "focal lengths"},
                      Implausible{"NotANumber", {640, 480, kNan, 500, 320, 240}, "finite"},
                      Implausible{"Infinite", {640, 480, 500, 500, 320, kInfinity}, "finite"},
                      Implausible{"CxAndFxSwapped", {640, 480, 318, 516, 517, 900}, "principal point"},
                      Implausible{"CxNegative", {640, 480, 500, 500, -1, 240}, "principal point"},
                      Implausible{"NoImage", {0, 0, 500, 500, 0, 0}, "pixels wide"},
                      Implausible{"HugeImage", {100000, 480, 50000, 50000, 320, 240}, "pixels wide"}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace test_camera
}  // namespace rosefusion::testing
