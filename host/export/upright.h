// Which way is up in a reconstruction, whose world is the first camera's.
#pragma once
#include <optional>
#include <span>

#include "host/core/camera.h"
#include "host/core/mesh.h"

namespace rosefusion {

/// What the cameras had for up on average, a unit vector of the world.
Eigen::Vector3d meanUp(std::span<const Pose> world_from_camera);

/// The normal of the floor, a unit vector: a large plane that faces roughly as `guess` (to 35 degrees) with
/// next to nothing below it. Nothing where no plane is clearly the floor.
std::optional<Eigen::Vector3d> floorNormal(const TriangleMesh& mesh, const Eigen::Vector3d& guess);

enum class UpAxis { Keep, Y, Z };

/// The rotation that brings `up` to the axis; identity for Keep.
Eigen::Matrix3d rotationToAxis(const Eigen::Vector3d& up, UpAxis axis);

/// Turns positions and normals, about the world's origin.
void turn(TriangleMesh& mesh, const Eigen::Matrix3d& rotation);

}  // namespace rosefusion
