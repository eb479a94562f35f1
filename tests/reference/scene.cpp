#include "tests/reference/scene.h"

#include <cmath>
#include <limits>
#include <random>

namespace rosefusion::reference {
namespace {

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * random() / 4294967296.0;
}

std::uint32_t colourAt(const Eigen::Vector3d& p) {
  std::uint32_t rgb = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double level = 127.5 + 120 * std::sin(5.0 * p[axis] + axis);
    rgb |= static_cast<std::uint32_t>(std::lround(level)) << (8 * axis);
  }
  return rgb;
}

}  // namespace

Scene makeScene(std::uint32_t seed) {
  std::mt19937 random(seed);
  Scene scene;
  for (int i = 0; i < 3; ++i)
    scene.spheres.push_back({{uniform(random, -1, 1), uniform(random, -0.6, 0.6), uniform(random, 1.2, 2.0)},
                             uniform(random, 0.2, 0.45)});
  return scene;
}

double castRay(const Scene& scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) continue;
    const double wall = direction[axis] > 0 ? scene.high[axis] : scene.low[axis];
    nearest = std::min(nearest, (wall - origin[axis]) / direction[axis]);
  }
  for (const Sphere& sphere : scene.spheres) {
    const Eigen::Vector3d to_centre = sphere.centre - origin;
    const double along = to_centre.dot(direction);
    const double inside = along * along - to_centre.squaredNorm() + sphere.radius * sphere.radius;
    if (inside < 0) continue;
    const double hit = along - std::sqrt(inside);
    if (hit > 0) nearest = std::min(nearest, hit);
  }
  return nearest;
}

std::vector<Pose> cameraPath(int frames, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::array<double, 6> phase{};
  for (double& p : phase) p = uniform(random, 0, 6.28);
  std::vector<Pose> path;
  for (int i = 0; i < frames; ++i) {
    const auto sway = [&](int k, double size) { return size * std::sin(phase[k] + (0.25 + 0.05 * k) * i); };
    Pose pose = Pose::Identity();
    pose.translation() = Eigen::Vector3d(sway(0, 0.2), sway(1, 0.15), sway(2, 0.2));
    pose.linear() = (Eigen::AngleAxisd(sway(3, 0.25), Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(sway(4, 0.15), Eigen::Vector3d::UnitX()) *
                     Eigen::AngleAxisd(sway(5, 0.2), Eigen::Vector3d::UnitZ()))
                        .toRotationMatrix();
    path.push_back(pose);
  }
  return path;
}

Image render(const Scene& scene, const Intrinsics& camera, const Pose& world_from_camera,
             double units_per_metre, double invalid_share, std::uint32_t seed) {
  std::mt19937 random(seed);
  Image image;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = camera.unproject(u, v, 1);
      const Eigen::Vector3d direction = world_from_camera.linear() * ray.normalized();
      const double distance = castRay(scene, world_from_camera.translation(), direction);
      const double z = distance / ray.norm();
      std::uint16_t depth = static_cast<std::uint16_t>(std::min(65534.0, std::round(z * units_per_metre)));
      if (uniform(random, 0, 1) < invalid_share) depth = random() % 2 ? 0 : 65535;
      image.depth.push_back(depth);
      image.rgb.push_back(colourAt(world_from_camera.translation() + distance * direction));
    }
  return image;
}

}  // namespace rosefusion::reference
