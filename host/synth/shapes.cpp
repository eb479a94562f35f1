#include "host/synth/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rosefusion {
namespace {

constexpr double kMaxEdge = 0.12;

int pieces(double length) {
  return std::max(1, static_cast<int>(std::ceil(length / kMaxEdge)));
}

int roundSegments(double radius) {
  return std::clamp(static_cast<int>(std::ceil(2 * std::numbers::pi * radius / 0.04)), 10, 40);
}

}  // namespace

ShapeBuilder ShapeBuilder::at(const Eigen::Vector3d& offset, double yaw) const {
  return at(Eigen::Translation3d(offset) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
            Eigen::Isometry3d::Identity());
}

std::uint16_t ShapeBuilder::addMaterial(const Material& material) const {
  scene_.materials.push_back(material);
  return static_cast<std::uint16_t>(scene_.materials.size() - 1);
}

/// surface(u, v) for u, v in [0, 1] must turn counter-clockwise about its outward normal.
template <typename Surface>
void ShapeBuilder::grid(int columns, int rows, std::uint16_t material, const Surface& surface) const {
  TriangleMesh& mesh = scene_.mesh;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column <= columns; ++column) {
      const Eigen::Vector3d p = place_ * surface(double(column) / columns, double(row) / rows);
      mesh.vertices.push_back(p.cast<float>());
    }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Eigen::Vector3f ab = mesh.vertices[b] - mesh.vertices[a], ac = mesh.vertices[c] - mesh.vertices[a];
    if (ab.cross(ac).squaredNorm() < 1e-14f) return;  // the poles of spheres, the centres of discs
    mesh.triangles.push_back({a, b, c});
    scene_.face_material.push_back(material);
  };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const std::uint32_t a = first + row * (columns + 1) + column, b = a + 1, d = a + columns + 1, c = d + 1;
      add(a, b, c);
      add(a, c, d);
    }
}

void ShapeBuilder::quad(const Eigen::Vector3d& corner, const Eigen::Vector3d& side_a,
                        const Eigen::Vector3d& side_b, std::uint16_t material) const {
  grid(pieces(side_a.norm()), pieces(side_b.norm()), material,
       [&](double u, double v) -> Eigen::Vector3d { return corner + u * side_a + v * side_b; });
}

void ShapeBuilder::box(const Eigen::Vector3d& size, std::uint16_t material) const {
  box({-size.x() / 2, -size.y() / 2, 0}, {size.x() / 2, size.y() / 2, size.z()}, material);
}

void ShapeBuilder::box(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                       std::uint16_t material) const {
  const Eigen::Vector3d size = high - low;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = a;
    a[(axis + 1) % 3] = size[(axis + 1) % 3];
    b[(axis + 2) % 3] = size[(axis + 2) % 3];
    quad(low, b, a, material);
    quad(high, -a, -b, material);
  }
}

void ShapeBuilder::frustum(double bottom_radius, double top_radius, double height,
                           std::uint16_t material) const {
  const int around = roundSegments(std::max(bottom_radius, top_radius));
  const auto ring = [](double radius, double turn, double z) -> Eigen::Vector3d {
    const double angle = turn * 2 * std::numbers::pi;
    return {radius * std::cos(angle), radius * std::sin(angle), z};
  };
  grid(around, pieces(height), material, [&](double u, double v) {
    return ring(bottom_radius + v * (top_radius - bottom_radius), u, v * height);
  });
  grid(around, 1, material, [&](double u, double v) { return ring(v * bottom_radius, u, 0); });
  grid(around, 1, material, [&](double u, double v) { return ring((1 - v) * top_radius, u, height); });
}

void ShapeBuilder::ellipsoid(const Eigen::Vector3d& radii, std::uint16_t material) const {
  const int around = roundSegments(radii.maxCoeff());
  grid(around, std::max(6, around / 2), material, [&](double u, double v) -> Eigen::Vector3d {
    const double longitude = u * 2 * std::numbers::pi, latitude = (v - 0.5) * std::numbers::pi;
    return radii.cwiseProduct(Eigen::Vector3d(std::cos(latitude) * std::cos(longitude),
                                              std::cos(latitude) * std::sin(longitude), std::sin(latitude)));
  });
}

void ShapeBuilder::curtain(double width, double height, double wave, std::uint16_t material) const {
  const int columns = std::max(8, static_cast<int>(width / 0.025));
  const auto cloth = [&](double u, double v, double side) -> Eigen::Vector3d {
    const double phase = u * width / 0.22 * 2 * std::numbers::pi;
    return {u * width, wave * std::sin(phase) + side * 0.008, v * height};
  };
  grid(columns, pieces(height), material, [&](double u, double v) { return cloth(u, v, -1); });
  grid(columns, pieces(height), material, [&](double u, double v) { return cloth(1 - u, v, 1); });
}

}  // namespace rosefusion
