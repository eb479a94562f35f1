#include "host/export/upright.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace rosefusion {
namespace {

struct Face {
  Eigen::Vector3d centre, normal;
  double area;
};

std::vector<Face> facesOf(const TriangleMesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>(), b = mesh.vertices[t[1]].cast<double>(),
                          c = mesh.vertices[t[2]].cast<double>();
    const Eigen::Vector3d twice = (b - a).cross(c - a);
    const double area = twice.norm() / 2;
    if (area > 1e-12) faces.push_back({(a + b + c) / 3, twice / (2 * area), area});
  }
  return faces;
}

}  // namespace

Eigen::Vector3d meanUp(std::span<const Pose> world_from_camera) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const Pose& pose : world_from_camera) up -= pose.linear().col(1);
  return up.norm() > 1e-6 ? up.normalized() : Eigen::Vector3d(-Eigen::Vector3d::UnitY());
}

std::optional<Eigen::Vector3d> floorNormal(const TriangleMesh& mesh, const Eigen::Vector3d& guess) {
  constexpr double kLayer = 0.05;       // metres of height that are looked at together
  constexpr double kLeastArea = 0.3;    // square metres
  constexpr double kLeastShare = 0.03;  // of the whole surface
  constexpr double kMostBelow = 0.02;   // of the whole surface
  const std::vector<Face> faces = facesOf(mesh);
  double whole = 0;
  for (const Face& face : faces) whole += face.area;
  Eigen::Vector3d up = guess.normalized();
  // From what may be a floor to what lies in one plane, each step more strictly.
  for (const double degrees : {35.0, 20.0, 10.0, 6.0}) {
    const double least = std::cos(degrees * std::acos(-1.0) / 180);
    std::map<long, double> areas;  // by height
    for (const Face& face : faces)
      if (face.normal.dot(up) > least) areas[std::lround(face.centre.dot(up) / kLayer)] += face.area;
    // The lowest layer that is large: a table is as flat, but higher.
    double largest = 0;
    for (const auto& [height, area] : areas) largest = std::max(largest, area);
    const auto floor = std::find_if(areas.begin(), areas.end(), [&](const auto& entry) {
      return entry.second > std::max({0.3 * largest, kLeastArea / 2, kLeastShare / 2 * whole});
    });
    if (floor == areas.end()) return {};
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double area = 0, below = 0;
    const double at = static_cast<double>(floor->first) * kLayer, half = (degrees > 15 ? 3 : 1.5) * kLayer;
    for (const Face& face : faces) {
      const double height = face.centre.dot(up) - at;
      if (height < -2 * half) below += face.area;
      if (face.normal.dot(up) <= least || std::abs(height) > half) continue;
      sum += face.area * face.normal;
      area += face.area;
    }
    if (area < kLeastArea || area < kLeastShare * whole || below > kMostBelow * whole) {
      if (degrees < 15) return {};
    }
    up = sum.normalized();
  }
  return up;
}

Eigen::Matrix3d rotationToAxis(const Eigen::Vector3d& up, UpAxis axis) {
  if (axis == UpAxis::Keep) return Eigen::Matrix3d::Identity();
  // Cameras have y down; turned about x first, what is left is a small turn without an ambiguity.
  const Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, -1).asDiagonal();
  const Eigen::Vector3d target = axis == UpAxis::Y ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  return Eigen::Quaterniond::FromTwoVectors(flip * up, target).toRotationMatrix() * flip;
}

void turn(TriangleMesh& mesh, const Eigen::Matrix3d& rotation) {
  const Eigen::Matrix3f r = rotation.cast<float>();
  for (Eigen::Vector3f& v : mesh.vertices) v = r * v;
  for (Eigen::Vector3f& n : mesh.normals) n = r * n;
  mesh.origin = rotation * mesh.origin;
}

}  // namespace rosefusion
