#include "host/synth/furniture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rosefusion {
namespace {

using Eigen::Vector3d;

void fourLegs(const ShapeBuilder& s, double width, double depth, double height, double thick,
              std::uint16_t material, bool round) {
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0}) {
      const ShapeBuilder leg = s.at({x * (width / 2 - thick), y * (depth / 2 - thick), 0});
      if (round)
        leg.frustum(thick * 0.35, thick * 0.6, height, material);
      else
        leg.box({thick, thick, height}, material);
    }
}

void buildBed(const ShapeBuilder& s, const Furniture& f, Rng& rng) {
  const auto wood = woodMaterial(s, rng), sheet = clothMaterial(s, rng), pillow = clothMaterial(s, rng);
  s.box({-f.width / 2, 0, 0.1}, {f.width / 2, f.depth, 0.32}, wood);
  fourLegs(s.at({0, f.depth / 2, 0}), f.width, f.depth, 0.1, 0.08, wood, false);
  s.box({-f.width / 2 + 0.04, 0.08, 0.32}, {f.width / 2 - 0.04, f.depth - 0.04, 0.52}, sheet);
  s.box({-f.width / 2, 0, 0}, {f.width / 2, 0.06, f.height}, wood);
  const int pillows = f.width > 1.3 ? 2 : 1;
  for (int i = 0; i < pillows; ++i)
    s.at({(i + 0.5 - pillows / 2.0) * f.width / pillows, 0.38, 0.57}, rng.uniform(-0.2, 0.2))
        .ellipsoid({0.32, 0.22, 0.11}, pillow);
  // A folded blanket at the foot, rumpled by a few flat ellipsoids.
  const auto blanket = clothMaterial(s, rng);
  for (int i = 0; i < 5; ++i)
    s.at({rng.uniform(-0.35, 0.35) * f.width, f.depth - rng.uniform(0.3, 0.8), 0.52}, rng.uniform(0, 3))
        .ellipsoid({rng.uniform(0.2, 0.4), rng.uniform(0.12, 0.3), rng.uniform(0.05, 0.13)}, blanket);
}

void buildSofa(const ShapeBuilder& s, const Furniture& f, Rng& rng) {
  const auto cloth = clothMaterial(s, rng), cushion = clothMaterial(s, rng);
  const double arm = 0.2, seat = 0.42, w = f.width / 2;
  s.box({-w, 0, 0.06}, {w, f.depth, seat - 0.12}, cloth);
  s.box({-w, 0, seat - 0.12}, {w, 0.24, f.height}, cloth);
  for (const double side : {-1.0, 1.0}) {
    s.at({side * (w - arm / 2), f.depth / 2, seat - 0.12}).box({arm, f.depth, 0.32}, cloth);
    // A rounded top on the arm, lying along y.
    s.at({side * (w - arm / 2), f.depth / 2, seat + 0.2}).ellipsoid({arm / 2, f.depth / 2, 0.07}, cloth);
  }
  const int seats = std::max(1, static_cast<int>(std::lround((f.width - 2 * arm) / 0.65)));
  const double each = (f.width - 2 * arm) / seats;
  for (int i = 0; i < seats; ++i) {
    const double x = -w + arm + (i + 0.5) * each;
    s.at({x, 0.24 + (f.depth - 0.24) / 2, seat - 0.12}).box({each - 0.02, f.depth - 0.24, 0.14}, cloth);
    if (rng.chance(0.7))
      s.at(Eigen::Translation3d(x, 0.36, seat + 0.22) *
           Eigen::AngleAxisd(rng.uniform(-0.4, -0.2), Vector3d::UnitX()) *
           Eigen::AngleAxisd(rng.uniform(-0.3, 0.3), Vector3d::UnitZ()) * Eigen::Isometry3d::Identity())
          .ellipsoid({each * 0.42, 0.1, 0.22}, cushion);
  }
}

void buildBookshelf(const ShapeBuilder& s, const Furniture& f, Rng& rng) {
  const auto wood = woodMaterial(s, rng);
  const double board = 0.025, w = f.width / 2;
  s.box({-w, 0, 0}, {w, 0.012, f.height}, wood);
  for (const double x : {-w, w - board}) s.box({x, 0, 0}, {x + board, f.depth, f.height}, wood);
  const int shelves = std::max(2, static_cast<int>(f.height / rng.uniform(0.3, 0.42)));
  const double pitch = (f.height - board) / shelves;
  for (int i = 0; i <= shelves; ++i) {
    s.box({-w, 0, i * pitch}, {w, f.depth, i * pitch + board}, wood);
    if (i == shelves) break;
    const ShapeBuilder level = s.at({-w + board, 0.02, i * pitch + board});
    if (rng.chance(0.75))
      addBooks(level, (f.width - 2 * board) * rng.uniform(0.5, 1), f.depth - 0.03, pitch - board, rng);
    else
      addClutter(level.at({w - board, f.depth / 2, 0}), f.width - 0.2, f.depth * 0.4, 3, rng);
  }
}

void buildWardrobe(const ShapeBuilder& s, const Furniture& f, Rng& rng) {
  const auto wood = woodMaterial(s, rng), metal = brightMaterial(s, rng);
  const int doors = std::max(1, static_cast<int>(std::lround(f.width / 0.55)));
  s.box({-f.width / 2, 0, 0.06}, {f.width / 2, f.depth - 0.02, f.height - 0.05}, wood);
  s.box({-f.width / 2 + 0.03, 0.03, 0}, {f.width / 2 - 0.03, f.depth - 0.06, 0.06}, wood);
  s.box({-f.width / 2 - 0.02, 0, f.height - 0.05}, {f.width / 2 + 0.02, f.depth + 0.03, f.height}, wood);
  for (int i = 0; i < doors; ++i) {
    const double x = -f.width / 2 + (i + 0.5) * f.width / doors, half = f.width / doors / 2 - 0.012;
    s.box({x - half, f.depth - 0.02, 0.08}, {x + half, f.depth, f.height - 0.08}, wood);
    s.box({x - half * 0.65, f.depth, 0.25}, {x + half * 0.65, f.depth + 0.015, f.height - 0.25}, wood);
    s.at({x + half * 0.85 * (i % 2 ? -1 : 1), f.depth + 0.03, 1.0}).ellipsoid({0.02, 0.03, 0.05}, metal);
  }
  if (rng.chance(0.7) && f.height < 2.1)
    addClutter(s.at({0, f.depth / 2, f.height}), f.width * 0.8, f.depth * 0.7, 3, rng);
}

void buildSideboard(const ShapeBuilder& s, const Furniture& f, Rng& rng) {
  const auto wood = woodMaterial(s, rng), metal = brightMaterial(s, rng);
  s.box({-f.width / 2, 0, 0.12}, {f.width / 2, f.depth - 0.02, f.height}, wood);
  fourLegs(s.at({0, f.depth / 2, 0}), f.width, f.depth, 0.12, 0.05, wood, true);
  const int columns = std::max(2, static_cast<int>(f.width / 0.5)), rows = 1 + rng.below(3);
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      const double w = f.width / columns, h = (f.height - 0.14) / rows;
      const Vector3d low(-f.width / 2 + i * w + 0.012, f.depth - 0.02, 0.13 + j * h + 0.01);
      s.box(low, low + Vector3d(w - 0.024, 0.022, h - 0.02), wood);
      s.at(low + Vector3d(w / 2, 0.03, h * 0.6)).ellipsoid({0.04, 0.02, 0.015}, metal);
    }
  addClutter(s.at({0, f.depth / 2, f.height}), f.width, f.depth, 5 + rng.below(4), rng);
}

void buildChair(const ShapeBuilder& s, std::uint16_t wood, std::uint16_t cloth, Rng& rng) {
  // Centred on its seat, back at -y.
  const double seat = 0.45, w = 0.42, back = rng.uniform(0.85, 1.0);
  fourLegs(s, w, w, seat, 0.04, wood, false);
  s.at({0, 0, seat}).box({w, w, 0.04}, wood);
  s.at({0, 0, seat + 0.05}).ellipsoid({w * 0.46, w * 0.46, 0.035}, cloth);
  for (const double x : {-1.0, 1.0})
    s.at({x * (w / 2 - 0.03), -w / 2 + 0.02, seat}).box({0.035, 0.035, back - seat}, wood);
  for (double z = seat + 0.15; z < back - 0.05; z += 0.14)
    s.at({0, -w / 2 + 0.02, z}).box({w - 0.08, 0.02, 0.07}, wood);
}

void buildDesk(const ShapeBuilder& s, const Furniture& f, Rng& rng) {
  const auto wood = woodMaterial(s, rng), dark = s.addMaterial({{45, 45, 50}, Pattern::Noise, 0.02f});
  s.box({-f.width / 2, 0, f.height - 0.03}, {f.width / 2, f.depth, f.height}, wood);
  fourLegs(s.at({0, f.depth / 2, 0}), f.width, f.depth, f.height - 0.03, 0.05, wood, false);
  s.box({f.width / 2 - 0.45, 0.05, 0.08}, {f.width / 2 - 0.06, f.depth - 0.05, f.height - 0.08}, wood);
  const ShapeBuilder top = s.at({-0.1, f.depth / 2, f.height});
  const ShapeBuilder monitor = top.at({0, -f.depth * 0.25, 0}, rng.uniform(-0.3, 0.3));
  monitor.frustum(0.12, 0.12, 0.015, dark);
  monitor.box({0.05, 0.03, 0.25}, dark);
  monitor.at({0, 0.03, 0.13}).box({rng.uniform(0.5, 0.75), 0.04, 0.36}, dark);
  top.at({0, f.depth * 0.2, 0}).box({0.42, 0.15, 0.025}, dark);
  addClutter(top, f.width * 0.9, f.depth * 0.8, 3 + rng.below(3), rng);
  buildChair(s.at({-0.1, f.depth + 0.1, 0}, std::numbers::pi + rng.uniform(-0.6, 0.6)), wood,
             clothMaterial(s, rng), rng);
}

void buildTableWithChairs(const ShapeBuilder& s, const Furniture& f, Rng& rng) {
  const auto wood = woodMaterial(s, rng), cloth = clothMaterial(s, rng);
  const double w = f.width - 0.8, d = f.depth - 0.8, top = 0.75;  // chairs stand in the 0.4 m around it
  const ShapeBuilder c = s.at({0, f.depth / 2, 0});
  if (rng.chance(0.35)) {
    const double r = std::min(w, d) / 2;
    c.at({0, 0, top - 0.035}).frustum(r, r, 0.035, wood);
    c.frustum(0.06, 0.05, top - 0.035, wood);
    c.frustum(r * 0.6, 0.08, 0.06, wood);
    addClutter(c.at({0, 0, top}), r * 1.3, r * 1.3, 4 + rng.below(4), rng);
  } else {
    c.at({0, 0, top - 0.04}).box({w, d, 0.04}, wood);
    fourLegs(c, w, d, top - 0.04, 0.07, wood, rng.chance(0.5));
    addClutter(c.at({0, 0, top}), w, d, 5 + rng.below(5), rng);
  }
  const double reach_x = w / 2 + 0.12, reach_y = d / 2 + 0.12;
  const Vector3d spots[] = {{0, -reach_y, 0}, {0, reach_y, 0}, {-reach_x, 0, 0}, {reach_x, 0, 0}};
  const double yaw[] = {0, std::numbers::pi, -std::numbers::pi / 2, std::numbers::pi / 2};
  for (int i = 0; i < 4; ++i)
    if (rng.chance(0.85)) buildChair(c.at(spots[i], yaw[i] + rng.uniform(-0.5, 0.5)), wood, cloth, rng);
}

void buildFloorLamp(const ShapeBuilder& s, const Furniture& f, Rng& rng) {
  const auto metal = s.addMaterial({{90, 90, 95}, Pattern::Noise, 0.03f}), shade = clothMaterial(s, rng);
  const ShapeBuilder c = s.at({0, f.depth / 2, 0});
  c.frustum(0.15, 0.13, 0.03, metal);
  c.frustum(0.016, 0.016, f.height - 0.2, metal);
  c.at({0, 0, f.height - 0.32}).frustum(0.2, 0.12, 0.32, shade);
}

void buildPlant(const ShapeBuilder& s, const Furniture& f, Rng& rng) {
  const auto pot = brightMaterial(s, rng), leaf = s.addMaterial({{60, 125, 55}, Pattern::Noise, 0.04f});
  const ShapeBuilder c = s.at({0, f.depth / 2, 0});
  c.frustum(0.13, 0.19, 0.34, pot);
  c.at({0, 0, 0.34}).frustum(0.02, 0.015, f.height * 0.5, leaf);
  for (int i = 0; i < 14; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(Vector3d(0, 0, 0.36 + f.height * rng.uniform(0.1, 0.5)));
    pose.rotate(Eigen::AngleAxisd(rng.uniform(0, 6.28), Vector3d::UnitZ()));
    pose.rotate(Eigen::AngleAxisd(rng.uniform(-1.2, -0.1), Vector3d::UnitY()));
    pose.translate(Vector3d(0.17, 0, 0));
    c.at(pose).ellipsoid({0.17, rng.uniform(0.04, 0.08), 0.015}, leaf);
  }
}

}  // namespace

Furniture randomBed(Rng& rng) {
  return {rng.uniform(0.95, 1.7), rng.uniform(1.9, 2.1), rng.uniform(0.8, 1.1), buildBed};
}
Furniture randomSofa(Rng& rng) {
  return {rng.uniform(1.6, 2.3), rng.uniform(0.85, 1.0), rng.uniform(0.75, 0.95), buildSofa};
}
Furniture randomArmchair(Rng& rng) {
  return {rng.uniform(0.85, 1.0), rng.uniform(0.8, 0.95), rng.uniform(0.8, 1.0), buildSofa};
}
Furniture randomBookshelf(Rng& rng) {
  return {rng.uniform(0.7, 1.5), rng.uniform(0.26, 0.36), rng.uniform(1.2, 2.2), buildBookshelf};
}
Furniture randomWardrobe(Rng& rng) {
  return {rng.uniform(0.9, 1.8), rng.uniform(0.5, 0.62), rng.uniform(1.8, 2.25), buildWardrobe};
}
Furniture randomSideboard(Rng& rng) {
  return {rng.uniform(1.0, 1.8), rng.uniform(0.38, 0.5), rng.uniform(0.6, 0.95), buildSideboard};
}
Furniture randomDesk(Rng& rng) {
  return {rng.uniform(1.2, 1.6), rng.uniform(0.65, 0.8), 0.74, buildDesk};
}
Furniture randomTableWithChairs(Rng& rng) {
  return {rng.uniform(1.6, 2.3), rng.uniform(1.5, 1.75), 0.95, buildTableWithChairs};
}
Furniture randomFloorLamp(Rng& rng) {
  return {0.42, 0.42, rng.uniform(1.4, 1.8), buildFloorLamp};
}
Furniture randomPlant(Rng& rng) {
  return {0.5, 0.5, rng.uniform(0.8, 1.5), buildPlant};
}

}  // namespace rosefusion
