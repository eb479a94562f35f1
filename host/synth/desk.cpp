// The procedural desk: a table at the wall of a bare room, with things on it.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/synth/furniture.h"
#include "host/synth/scene.h"
#include "host/synth/shapes.h"

namespace rosefusion {

namespace {

void buildScreen(const ShapeBuilder& s, Rng& rng) {
  const auto dark = s.addMaterial({{60, 60, 66}, Pattern::Noise, 0.03f});
  s.frustum(0.11, 0.11, 0.015, dark);
  s.box({0.05, 0.03, 0.22}, dark);
  s.at({0, 0.03, 0.12}).box({rng.uniform(0.4, 0.6), 0.035, rng.uniform(0.26, 0.34)}, dark);
}

void buildThing(const ShapeBuilder& s, int kind, Rng& rng) {
  const std::uint16_t material = rng.chance(0.7) ? brightMaterial(s, rng) : clothMaterial(s, rng);
  switch (kind % 6) {
    case 0:
      s.box({rng.uniform(0.06, 0.25), rng.uniform(0.06, 0.2), rng.uniform(0.05, 0.28)}, material);
      break;
    case 1: {
      const double radius = rng.uniform(0.03, 0.08);
      s.frustum(radius, radius, rng.uniform(0.08, 0.3), material);
      break;
    }
    case 2: {
      const double radius = rng.uniform(0.04, 0.11);
      s.at({0, 0, radius}).ellipsoid({radius, radius, radius}, material);
      break;
    }
    case 3: {
      double z = 0;
      for (int book = 2 + rng.below(4); book > 0; --book) {
        const double thick = rng.uniform(0.015, 0.045);
        s.at({0, 0, z}, rng.uniform(-0.3, 0.3))
            .box({rng.uniform(0.13, 0.2), rng.uniform(0.18, 0.26), thick}, brightMaterial(s, rng));
        z += thick;
      }
      break;
    }
    case 4:
      s.frustum(rng.uniform(0.03, 0.06), rng.uniform(0.07, 0.12), rng.uniform(0.06, 0.2), material);
      break;
    default:
      addBooks(s.at({-0.12, -0.08, 0}), rng.uniform(0.15, 0.28), 0.17, rng.uniform(0.18, 0.26), rng);
  }
}

}  // namespace

Scene makeDesk(std::uint64_t seed) {
  Rng rng(seed, 3);
  Scene scene;
  const ShapeBuilder shapes(scene, Eigen::Isometry3d::Identity());
  const Eigen::Vector3d room(rng.uniform(3.2, 4.5), rng.uniform(3.0, 4.0), 2.6);
  buildShell(shapes, room, rng);
  const double width = rng.uniform(1.3, 1.7), depth = rng.uniform(0.7, 0.85), height = 0.74;
  const ShapeBuilder desk = shapes.at({room.x() / 2 + rng.uniform(-0.3, 0.3), 0.03 + depth / 2, 0});
  const auto wood = woodMaterial(desk, rng);
  desk.at({0, 0, height - 0.03}).box({width, depth, 0.03}, wood);
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      desk.at({x * (width / 2 - 0.05), y * (depth / 2 - 0.05), 0}).box({0.05, 0.05, height - 0.03}, wood);

  // Far things, so that a look over the table's edge ends somewhere.
  const Furniture shelf = randomBookshelf(rng);
  shelf.build(shapes.at({room.x() * 0.3, room.y() - 0.02, 0}, std::numbers::pi), shelf, rng);
  const Furniture board = randomSideboard(rng);
  board.build(shapes.at({0.02, room.y() * 0.55, 0}, -std::numbers::pi / 2), board, rng);

  const ShapeBuilder top = desk.at({0, 0, height});
  std::vector<Eigen::Vector2d> taken{{rng.uniform(-0.2, 0.2) * width, -0.28 * depth}};
  buildScreen(top.at({taken[0].x(), taken[0].y(), 0}, rng.uniform(-0.3, 0.3)), rng);
  const int things = 7 + rng.below(8);
  for (int i = 0; i < things; ++i)
    for (int attempt = 0; attempt < 50; ++attempt) {
      const Eigen::Vector2d spot(rng.uniform(-0.43, 0.43) * width, rng.uniform(-0.36, 0.38) * depth);
      if (std::any_of(taken.begin(), taken.end(), [&](const auto& t) { return (t - spot).norm() < 0.17; }))
        continue;
      taken.push_back(spot);
      buildThing(top.at({spot.x(), spot.y(), 0}, rng.uniform(0, 2 * std::numbers::pi)), i + rng.below(2),
                 rng);
      break;
    }
  paintVertices(scene);
  scene.subject = {desk.toWorld({0, 0, height}), {width / 2, depth / 2, 0.15}, 0, 0};
  return scene;
}

}  // namespace rosefusion
