// A sphere in a box, fused from depth images of all sides: the volume that raycast and extract are tested on.
#pragma once
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "engine/passes/allocate.h"
#include "engine/passes/integrate.h"
#include "engine/passes/preprocess.h"
#include "tests/reference/raycast_field.h"

namespace rosefusion::testing {

inline constexpr double kSphereRadius = 0.5;              // at the origin
inline constexpr double kBoxHalf = 1.6;                   // half the side of the box around it
inline constexpr double kCameraDistance = 1.3;            // of the cameras from the origin
inline constexpr std::uint32_t kSphereColour = 0x3060C0;  // red C0, green 60, blue 30
inline constexpr std::uint32_t kBoxColour = 0xA0A020;

/// Distance from `origin`, inside the box and outside the sphere, to the first surface along unit
/// `direction`.
double sphereInBox(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

/// Pose at `position` that looks at `target`.
Eigen::Isometry3d lookAt(const Eigen::Vector3d& position, const Eigen::Vector3d& target);

/// One camera over each face and each corner of a cube around the sphere, kCameraDistance from its centre.
std::vector<Eigen::Isometry3d> posesAllAround();

glm::mat4 toGlm(const Eigen::Isometry3d& pose);

struct SceneOptions {
  float voxel_size = 0.02f;
  bool colour = false;
};

/// A volume and what it takes to fuse analytic depth images into it.
class SurfaceScene {
 public:
  SurfaceScene(Device& device, const SceneOptions& options);

  using Distance = std::function<double(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction)>;
  /// `distance`: metres along the unit direction, 0 where the camera sees nothing.
  void fuse(const Eigen::Isometry3d& world_from_camera, const Distance& distance = sphereInBox);
  /// The volume as the references see it; `stretch` other than 1 gives it a wrong voxel size.
  reference::Field field(double stretch = 1);

  shader::CameraIntrinsics camera;
  Volume volume;
  Recorder recorder;

 private:
  PreprocessPass preprocess_;
  AllocatePass allocate_;
  IntegratePass integrate_;
  bool colour_;
};

/// Device with validation ($ROSEFUSION_DEVICE, else Mesa's software device); what the layer says fails the
/// test.
class SurfaceTest : public ::testing::Test {
 protected:
  SurfaceTest();
  void TearDown() override;
  Device device;
};

/// Contents of a device buffer.
template <typename T>
std::vector<T> download(Device& device, const BufferPart& part) {
  const Buffer copy(device, part.bytes, Memory::Readback);
  Recorder recorder(device);
  recorder.copy(part.buffer, copy, part.bytes, part.offset);
  recorder.submit();
  const auto contents = copy.as<T>();
  return {contents.begin(), contents.end()};
}

}  // namespace rosefusion::testing
