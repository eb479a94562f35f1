// The things that stand in a procedural room.
#pragma once
#include "host/synth/random.h"
#include "host/synth/shapes.h"

namespace rosefusion {

/// A kind of furniture: its size and how it is built. The local frame has its origin on the floor at the
/// middle of the back edge, x along the width, y towards the front, z up.
struct Furniture {
  double width, depth, height;  ///< metres; everything built lies within, apart from small overhangs
  void (*build)(const ShapeBuilder& shapes, const Furniture& size, Rng& rng);
};

Furniture randomBed(Rng& rng);
Furniture randomSofa(Rng& rng);
Furniture randomArmchair(Rng& rng);
Furniture randomBookshelf(Rng& rng);
Furniture randomWardrobe(Rng& rng);
Furniture randomSideboard(Rng& rng);
Furniture randomDesk(Rng& rng);
Furniture randomTableWithChairs(Rng& rng);
Furniture randomFloorLamp(Rng& rng);
Furniture randomPlant(Rng& rng);

/// Small things (balls, cups, boxes, cones, piles of books) on a horizontal surface centred on the local
/// origin.
void addClutter(const ShapeBuilder& shapes, double width, double depth, int count, Rng& rng);

/// Books standing from x = 0 to `length`, their backs at y = 0, within `depth` and `height`.
void addBooks(const ShapeBuilder& shapes, double length, double depth, double height, Rng& rng);

/// Floor, ceiling and four walls of a room from the origin to `size`, seen from inside.
void buildShell(const ShapeBuilder& shapes, const Eigen::Vector3d& size, Rng& rng);

std::uint16_t woodMaterial(const ShapeBuilder& shapes, Rng& rng);
std::uint16_t clothMaterial(const ShapeBuilder& shapes, Rng& rng);
std::uint16_t brightMaterial(const ShapeBuilder& shapes, Rng& rng);

}  // namespace rosefusion
