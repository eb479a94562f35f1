// Basic solids, tessellated finely enough that vertex colours and visibility per triangle mean something.
#pragma once
#include <Eigen/Geometry>

#include "host/synth/random.h"
#include "host/synth/scene.h"

namespace rosefusion {

/// Adds solids to a scene. Every shape is given in a local frame (z up, standing on its own origin unless
/// said otherwise) that `place` maps to the world; triangles face outwards. Lengths in metres.
class ShapeBuilder {
 public:
  ShapeBuilder(Scene& scene, Eigen::Isometry3d place) : scene_(scene), place_(std::move(place)) {}

  /// The same scene, in a frame moved by `offset` and turned by `yaw` about z.
  ShapeBuilder at(const Eigen::Vector3d& offset, double yaw = 0) const;
  ShapeBuilder at(const Eigen::Isometry3d& local) const { return {scene_, place_ * local}; }

  Eigen::Vector3d toWorld(const Eigen::Vector3d& local) const { return place_ * local; }

  std::uint16_t addMaterial(const Material& material) const;

  /// Box whose base centre is the origin.
  void box(const Eigen::Vector3d& size, std::uint16_t material) const;
  /// Box between two corners.
  void box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, std::uint16_t material) const;
  /// Upright frustum (a cylinder for equal radii) with caps.
  void frustum(double bottom_radius, double top_radius, double height, std::uint16_t material) const;
  /// Ellipsoid about the origin.
  void ellipsoid(const Eigen::Vector3d& radii, std::uint16_t material) const;
  /// Parallelogram from `corner`; faces along cross(side_a, side_b).
  void quad(const Eigen::Vector3d& corner, const Eigen::Vector3d& side_a, const Eigen::Vector3d& side_b,
            std::uint16_t material) const;
  /// Cloth hanging from (0, 0) to (width, 0), waves of the given depth along y; both sides are surface.
  void curtain(double width, double height, double wave, std::uint16_t material) const;

 private:
  template <typename Surface>
  void grid(int columns, int rows, std::uint16_t material, const Surface& surface) const;

  Scene& scene_;
  Eigen::Isometry3d place_;
};

}  // namespace rosefusion
