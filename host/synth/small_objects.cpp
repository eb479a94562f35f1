// Materials, books and the small things on tables.
#include <algorithm>
#include <cmath>

#include "host/synth/furniture.h"

namespace rosefusion {
namespace {

std::uint8_t channel(double value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
}

std::array<std::uint8_t, 3> tint(double r, double g, double b, double spread, Rng& rng) {
  const double light = rng.uniform(1 - spread, 1 + spread);
  return {channel(r * light), channel(g * light), channel(b * light)};
}

}  // namespace

std::uint16_t woodMaterial(const ShapeBuilder& shapes, Rng& rng) {
  return shapes.addMaterial({tint(165, rng.uniform(105, 130), rng.uniform(60, 90), 0.3, rng), Pattern::Wood,
                             static_cast<float>(rng.uniform(0.03, 0.07))});
}

std::uint16_t clothMaterial(const ShapeBuilder& shapes, Rng& rng) {
  const Pattern patterns[] = {Pattern::Noise, Pattern::Stripes, Pattern::Checker};
  return shapes.addMaterial({tint(rng.uniform(70, 200), rng.uniform(70, 200), rng.uniform(70, 200), 0.2, rng),
                             patterns[rng.below(3)], static_cast<float>(rng.uniform(0.04, 0.1))});
}

std::uint16_t brightMaterial(const ShapeBuilder& shapes, Rng& rng) {
  return shapes.addMaterial({tint(rng.uniform(30, 240), rng.uniform(30, 240), rng.uniform(30, 240), 0.1, rng),
                             Pattern::Noise, static_cast<float>(rng.uniform(0.02, 0.05))});
}

void addBooks(const ShapeBuilder& shapes, double length, double depth, double height, Rng& rng) {
  double x = 0;
  while (x < length) {
    const double thickness = rng.uniform(0.02, 0.055);
    if (x + thickness > length) break;
    if (rng.chance(0.06)) {  // a gap, now and then
      x += rng.uniform(0.04, 0.12);
      continue;
    }
    const double tall = height * rng.uniform(0.6, 0.95), deep = depth * rng.uniform(0.55, 0.95);
    shapes.box({x, 0, 0}, {x + thickness * 0.96, deep, tall}, brightMaterial(shapes, rng));
    x += thickness;
  }
}

void addClutter(const ShapeBuilder& shapes, double width, double depth, int count, Rng& rng) {
  for (int i = 0; i < count; ++i) {
    const ShapeBuilder spot = shapes.at(
        {rng.uniform(-0.42, 0.42) * width, rng.uniform(-0.38, 0.38) * depth, 0}, rng.uniform(0, 6.28));
    const std::uint16_t material = brightMaterial(spot, rng);
    switch (rng.below(6)) {
      case 0: {
        const double radius = rng.uniform(0.04, 0.12);
        spot.at({0, 0, radius}).ellipsoid({radius, radius, radius}, material);
        break;
      }
      case 1: {  // a cup or bottle
        const double radius = rng.uniform(0.03, 0.07), height = rng.uniform(0.08, 0.3);
        spot.frustum(radius, radius, height, material);
        if (height > 0.2) spot.at({0, 0, height}).frustum(radius, radius * 0.35, 0.07, material);
        break;
      }
      case 2:
        spot.box({rng.uniform(0.06, 0.22), rng.uniform(0.06, 0.22), rng.uniform(0.04, 0.25)}, material);
        break;
      case 3:
        spot.frustum(rng.uniform(0.04, 0.07), rng.uniform(0.09, 0.15), rng.uniform(0.06, 0.14), material);
        break;
      case 4: {  // a pile of books
        double z = 0;
        for (int book = 1 + rng.below(4); book > 0; --book) {
          const double thick = rng.uniform(0.015, 0.045);
          spot.at({0, 0, z}, rng.uniform(-0.3, 0.3))
              .box({rng.uniform(0.13, 0.2), rng.uniform(0.18, 0.28), thick}, brightMaterial(spot, rng));
          z += thick;
        }
        break;
      }
      default: {  // a vase
        const double radius = rng.uniform(0.05, 0.1);
        spot.at({0, 0, radius * 1.2}).ellipsoid({radius, radius, radius * 1.2}, material);
        spot.at({0, 0, radius * 2.1}).frustum(radius * 0.35, radius * 0.6, radius * 1.5, material);
      }
    }
  }
}

}  // namespace rosefusion
