// The procedural object: one thing of a few solids on a round plate, in the middle of a room.
#include <numbers>

#include "host/synth/furniture.h"
#include "host/synth/scene.h"
#include "host/synth/shapes.h"

namespace rosefusion {

void buildShell(const ShapeBuilder& shapes, const Eigen::Vector3d& size, Rng& rng) {
  const auto plaster = [&](double light) {
    const auto byte = static_cast<std::uint8_t>(light);
    return shapes.addMaterial({{byte, byte, static_cast<std::uint8_t>(0.95 * light)}, Pattern::Noise, 0.12f});
  };
  const auto floor = woodMaterial(shapes, rng), wall = plaster(rng.uniform(170, 230)), ceiling = plaster(235);
  const double w = size.x(), d = size.y(), h = size.z();
  shapes.quad({0, 0, 0}, {w, 0, 0}, {0, d, 0}, floor);
  shapes.quad({0, 0, h}, {0, d, 0}, {w, 0, 0}, ceiling);
  shapes.quad({0, 0, 0}, {0, 0, h}, {w, 0, 0}, wall);
  shapes.quad({0, d, 0}, {w, 0, 0}, {0, 0, h}, wall);
  shapes.quad({0, 0, 0}, {0, d, 0}, {0, 0, h}, wall);
  shapes.quad({w, 0, 0}, {0, 0, h}, {0, d, 0}, wall);
}

Scene makeObject(std::uint64_t seed) {
  Rng rng(seed, 4);
  Scene scene;
  const ShapeBuilder shapes(scene, Eigen::Isometry3d::Identity());
  const Eigen::Vector3d room(4, 4, 2.6);
  buildShell(shapes, room, rng);
  for (const double x : {0.3, 0.7}) {
    const Furniture shelf = randomBookshelf(rng), board = randomSideboard(rng);
    shelf.build(shapes.at({room.x() * x, room.y() - 0.02, 0}, std::numbers::pi), shelf, rng);
    board.build(shapes.at({room.x() * x, 0.02, 0}), board, rng);
  }
  const double table = 0.7, size = rng.uniform(0.2, 0.6);
  const ShapeBuilder plate = shapes.at({room.x() / 2, room.y() / 2, 0});
  plate.frustum(0.12, 0.12, table - 0.02, woodMaterial(shapes, rng));
  plate.at({0, 0, table - 0.02}).frustum(0.32, 0.32, 0.02, woodMaterial(shapes, rng));

  // A body, something on top of it and something at its sides: never round about the axis it is turned on.
  const auto first = static_cast<std::uint32_t>(scene.mesh.triangles.size());
  const ShapeBuilder body = plate.at({0, 0, table}, rng.uniform(0, 2 * std::numbers::pi));
  const double lower = size * rng.uniform(0.45, 0.65), upper = size - lower,
               half = size * rng.uniform(0.18, 0.3);
  const auto skin = brightMaterial(body, rng), other = clothMaterial(body, rng),
             third = brightMaterial(body, rng);
  switch (rng.below(3)) {
    case 0:
      body.box({2 * half, 1.4 * half, lower}, skin);
      break;
    case 1:
      body.frustum(half, half * rng.uniform(0.6, 1), lower, skin);
      break;
    default:
      body.at({0, 0, lower / 2}).ellipsoid({half, 0.8 * half, lower / 2}, skin);
  }
  const ShapeBuilder head =
      body.at({rng.uniform(-0.2, 0.2) * half, rng.uniform(-0.2, 0.2) * half, lower * 0.96});
  if (rng.chance(0.5))
    head.at({0, 0, upper * 0.5}).ellipsoid({0.7 * half, 0.6 * half, upper * 0.55}, other);
  else
    head.box({half, 1.2 * half, upper}, other);
  const int sides = 2 + rng.below(3);
  for (int i = 0; i < sides; ++i) {
    const double yaw = (i + rng.uniform(-0.3, 0.3)) * 2 * std::numbers::pi / sides;
    const ShapeBuilder side =
        body.at({0, 0, 0}, yaw).at({0.9 * half, 0, size * rng.uniform(0.1, 0.6)}, rng.uniform(-0.6, 0.6));
    if (rng.chance(0.5))
      side.box({0.7 * half, 0.4 * half, size * rng.uniform(0.1, 0.25)}, third);
    else
      side.ellipsoid({0.6 * half, 0.25 * half, 0.35 * half}, third);
  }
  const auto end = static_cast<std::uint32_t>(scene.mesh.triangles.size());
  paintVertices(scene);
  scene.subject = {plate.toWorld({0, 0, table + size / 2}), {1.5 * half, 1.5 * half, size / 2}, first, end};
  return scene;
}

}  // namespace rosefusion
