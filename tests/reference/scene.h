// A seeded analytic scene, rendered on the CPU: the input of the engine's tests.
#pragma once
#include <cstdint>
#include <vector>

#include "host/core/camera.h"

namespace rosefusion::reference {

struct Sphere {
  Eigen::Vector3d centre{0, 0, 0};
  double radius = 0;
};

/// The inside of a box with spheres in it; metres, world frame.
struct Scene {
  Eigen::Vector3d low{-2, -1.25, -2};
  Eigen::Vector3d high{2, 1.25, 2.5};
  std::vector<Sphere> spheres;
};

Scene makeScene(std::uint32_t seed);

/// Distance from `origin` to the first surface along the unit vector `direction`.
double castRay(const Scene& scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

/// world_from_camera of a camera that sways about the origin and looks along +z, up to 6 cm and 4 degrees a
/// frame.
std::vector<Pose> cameraPath(int frames, std::uint32_t seed);

struct Image {
  std::vector<std::uint16_t> depth;  ///< row by row, units of the sensor; 0 and 65535 are invalid
  std::vector<std::uint32_t> rgb;    ///< red in the low byte
};

/// `invalid_share` of the pixels, chosen by `seed`, get depth 0 or 65535.
Image render(const Scene& scene, const Intrinsics& camera, const Pose& world_from_camera,
             double units_per_metre, double invalid_share, std::uint32_t seed);

}  // namespace rosefusion::reference
