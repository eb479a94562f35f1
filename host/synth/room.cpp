// The procedural room: a shell with recessed windows and a door, and furniture that does not overlap.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/synth/furniture.h"
#include "host/synth/scene.h"
#include "host/synth/shapes.h"

namespace rosefusion {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

/// Part of a wall that is taken: along the wall and in height.
struct Span {
  double low, high, bottom, top;
};

struct Wall {
  Vector3d corner;  ///< where the wall's x axis starts; its y axis points out of the room
  double yaw, length;
  std::vector<Span> openings;
  std::vector<Span> taken;  ///< openings and tall furniture
  bool isFree(const Span& s, double gap) const {
    return std::none_of(taken.begin(), taken.end(), [&](const Span& t) {
      return s.low < t.high + gap && t.low < s.high + gap && s.bottom < t.top && t.bottom < s.top;
    });
  }
};

struct Rectangle {
  double x0, y0, x1, y1;
};

class RoomMaker {
 public:
  explicit RoomMaker(std::uint64_t seed)
      : rng_(seed, 1),
        shapes_(scene_, Eigen::Isometry3d::Identity()),
        width_(rng_.uniform(4.0, 7.0)),
        depth_(rng_.uniform(3.5, 6.0)),
        height_(rng_.uniform(2.5, 3.0)) {}

  Scene make() {
    makeWalls();
    cutOpenings();
    buildShell();
    furnish();
    decorate();
    paintVertices(scene_);
    return std::move(scene_);
  }

 private:
  void makeWalls() {
    walls_ = {Wall{{width_, 0, 0}, kPi, width_, {}, {}}, Wall{{width_, depth_, 0}, -kPi / 2, depth_, {}, {}},
              Wall{{0, depth_, 0}, 0, width_, {}, {}}, Wall{{0, 0, 0}, kPi / 2, depth_, {}, {}}};
  }

  void cutOpenings() {
    const int door_wall = rng_.below(4);
    for (int i = 0; i < 4; ++i) {
      Wall& wall = walls_[i];
      if (i == door_wall) {
        const double x = rng_.uniform(0.3, wall.length - 1.3);
        wall.openings.push_back({x, x + 0.92, 0, 2.05});
      } else if (rng_.chance(0.65)) {
        const double w = rng_.uniform(0.9, std::min(1.9, wall.length - 1.2));
        const double x = rng_.uniform(0.5, wall.length - 0.5 - w), sill = rng_.uniform(0.75, 1.0);
        wall.openings.push_back({x, x + w, sill, rng_.uniform(2.0, 2.25)});
      }
      wall.taken = wall.openings;
    }
  }

  ShapeBuilder onWall(const Wall& wall) const { return shapes_.at(wall.corner, wall.yaw); }

  void buildShell() {
    const auto plaster = [&](double r, double g, double b) {
      const auto byte = [](double v) { return static_cast<std::uint8_t>(v); };
      return shapes_.addMaterial({{byte(r), byte(g), byte(b)}, Pattern::Noise, 0.12f});
    };
    const auto floor = rng_.chance(0.5) ? woodMaterial(shapes_, rng_)
                                        : shapes_.addMaterial({{170, 165, 155}, Pattern::Checker, 0.3f});
    const auto ceiling = plaster(235, 235, 230);
    shapes_.quad({0, 0, 0}, {width_, 0, 0}, {0, depth_, 0}, floor);
    shapes_.quad({0, 0, height_}, {0, depth_, 0}, {width_, 0, 0}, ceiling);
    const auto paint = plaster(rng_.uniform(190, 235), rng_.uniform(190, 230), rng_.uniform(175, 225));
    const auto trim = plaster(225, 220, 210);
    for (const Wall& wall : walls_) {
      const ShapeBuilder s = onWall(wall);
      double x = 0;
      for (const Span& o : wall.openings) {
        s.quad({x, 0, 0}, {o.low - x, 0, 0}, {0, 0, height_}, paint);
        if (o.bottom > 0) s.quad({o.low, 0, 0}, {o.high - o.low, 0, 0}, {0, 0, o.bottom}, paint);
        s.quad({o.low, 0, o.top}, {o.high - o.low, 0, 0}, {0, 0, height_ - o.top}, paint);
        buildOpening(s, o, trim);
        x = o.high;
      }
      s.quad({x, 0, 0}, {wall.length - x, 0, 0}, {0, 0, height_}, paint);
      s.box({0, -0.06, height_ - 0.09}, {wall.length, 0, height_}, trim);  // cornice
      double skirting = 0;
      for (const Span& o : wall.openings) {
        if (o.bottom > 0) continue;
        s.box({skirting, -0.02, 0}, {o.low, 0, 0.08}, trim);
        skirting = o.high;
      }
      s.box({skirting, -0.02, 0}, {wall.length, 0, 0.08}, trim);
    }
  }

  void buildOpening(const ShapeBuilder& s, const Span& o, std::uint16_t trim) {
    const bool door = o.bottom <= 0;
    const double deep = door ? 0.1 : rng_.uniform(0.18, 0.32), w = o.high - o.low, h = o.top - o.bottom;
    const auto panel = door ? woodMaterial(s, rng_) : s.addMaterial({{150, 180, 200}, Pattern::Noise, 0.25f});
    s.quad({o.low, deep, o.bottom}, {w, 0, 0}, {0, 0, h}, panel);
    s.quad({o.low, 0, o.bottom}, {0, deep, 0}, {0, 0, h}, trim);       // left reveal, faces +x
    s.quad({o.high, deep, o.bottom}, {0, -deep, 0}, {0, 0, h}, trim);  // right reveal, faces -x
    s.quad({o.low, 0, o.top}, {0, deep, 0}, {w, 0, 0}, trim);          // lintel, faces down
    s.quad({o.low, 0, o.bottom}, {w, 0, 0}, {0, deep, 0}, trim);       // sill, faces up
    for (const double x : {o.low - 0.07, o.high})
      s.box({x, -0.025, o.bottom}, {x + 0.07, 0, o.top + 0.07}, trim);
    s.box({o.low, -0.025, o.top}, {o.high, 0, o.top + 0.07}, trim);
    if (door) {
      for (const double z : {0.2, 1.15})
        s.box({o.low + 0.15, deep - 0.025, z}, {o.high - 0.15, deep, z + 0.7}, panel);
      s.at({o.low + 0.09, deep - 0.06, 1.02}).ellipsoid({0.06, 0.05, 0.02}, trim);
      return;
    }
    s.box({o.low, deep - 0.05, o.bottom}, {o.high, deep, o.bottom + 0.06}, trim);
    s.box({o.low, deep - 0.05, o.top - 0.06}, {o.high, deep, o.top}, trim);
    for (double x = o.low; x <= o.high - 0.05; x += (w - 0.06) / 2)
      s.box({x, deep - 0.05, o.bottom}, {x + 0.06, deep, o.top}, trim);
    s.box({o.low - 0.1, -0.12, o.bottom - 0.04}, {o.high + 0.1, 0, o.bottom}, trim);  // window board
    if (rng_.chance(0.75)) {
      const auto cloth = clothMaterial(s, rng_);
      const double hang = std::min(0.6, w * 0.35);
      for (const double x : {o.low - 0.25, o.high + 0.25 - hang})
        s.at({x, -0.09, 0.05}).curtain(hang, o.top + 0.05, 0.035, cloth);
      const Eigen::Isometry3d rod = Eigen::Translation3d(o.low - 0.35, -0.09, o.top + 0.12) *
                                    Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY()) *
                                    Eigen::Isometry3d::Identity();
      s.at(rod).frustum(0.016, 0.016, w + 0.7, trim);
    }
    if (rng_.chance(0.6))
      for (double x = o.low + 0.1; x < o.high - 0.15; x += 0.09)  // radiator
        s.box({x, -0.14, 0.12}, {x + 0.06, -0.04, o.bottom - 0.15}, trim);
  }

  bool overlaps(const Rectangle& r, double gap) const {
    return std::any_of(footprints_.begin(), footprints_.end(), [&](const Rectangle& f) {
      return r.x0 < f.x1 + gap && f.x0 < r.x1 + gap && r.y0 < f.y1 + gap && f.y0 < r.y1 + gap;
    });
  }

  Rectangle footprint(const Vector3d& back, double yaw, const Furniture& f) const {
    const Vector3d along(std::cos(yaw), std::sin(yaw), 0), front(-along.y(), along.x(), 0);
    const Vector3d a = back - along * f.width / 2, b = back + along * f.width / 2 + front * f.depth;
    return {std::min(a.x(), b.x()), std::min(a.y(), b.y()), std::max(a.x(), b.x()), std::max(a.y(), b.y())};
  }

  /// Stands `f` with its back to a wall; gives up after some tries (a full room stays as it is).
  void placeAtWall(const Furniture& f) {
    for (int attempt = 0; attempt < 60; ++attempt) {
      Wall& wall = walls_[rng_.below(4)];
      if (wall.length < f.width + 0.1) continue;
      const double x = rng_.uniform(f.width / 2 + 0.03, wall.length - f.width / 2 - 0.03);
      const Span span{x - f.width / 2, x + f.width / 2, 0, f.height};
      // In front of a window stand only things lower than its board; nothing stands in front of the door.
      if (!wall.isFree(span, 0.12)) continue;
      const bool behind = !wall.isFree({span.low, span.high, 0, 3}, 0.3);
      const Vector3d along(std::cos(wall.yaw), std::sin(wall.yaw), 0), in(along.y(), -along.x(), 0);
      const Vector3d back = wall.corner + along * x + in * (behind ? 0.18 : 0.03);
      const double yaw = wall.yaw + kPi;
      const Rectangle r = footprint(back, yaw, f);
      if (overlaps(r, 0.05)) continue;
      footprints_.push_back(r);
      wall.taken.push_back(span);
      f.build(shapes_.at(back, yaw), f, rng_);
      return;
    }
  }

  void placeInMiddle(const Furniture& f) {
    for (int attempt = 0; attempt < 40; ++attempt) {
      const double yaw = rng_.below(4) * kPi / 2;
      const Vector3d back(rng_.uniform(0.8, width_ - 0.8), rng_.uniform(0.8, depth_ - 0.8), 0);
      const Rectangle r = footprint(back, yaw, f);
      if (r.x0 < 0.3 || r.y0 < 0.3 || r.x1 > width_ - 0.3 || r.y1 > depth_ - 0.3 || overlaps(r, 0.15))
        continue;
      footprints_.push_back(r);
      f.build(shapes_.at(back, yaw + rng_.uniform(-0.15, 0.15)), f, rng_);
      return;
    }
  }

  void furnish() {
    for (const Wall& wall : walls_)  // keep the door's swing free
      for (const Span& o : wall.openings) {
        if (o.bottom > 0) continue;
        const Vector3d along(std::cos(wall.yaw), std::sin(wall.yaw), 0);
        footprints_.push_back(footprint(wall.corner + along * (o.low + o.high) / 2, wall.yaw + kPi,
                                        {o.high - o.low, 0.9, 0, nullptr}));
      }
    placeAtWall(rng_.chance(0.5) ? randomBed(rng_) : randomSofa(rng_));
    placeAtWall(randomBookshelf(rng_));
    placeAtWall(randomWardrobe(rng_));
    placeInMiddle(randomTableWithChairs(rng_));
    placeAtWall(randomDesk(rng_));
    placeAtWall(randomSideboard(rng_));
    if (rng_.chance(0.7)) placeAtWall(randomBookshelf(rng_));
    if (rng_.chance(0.7)) placeAtWall(randomArmchair(rng_));
    if (width_ * depth_ > 24) placeAtWall(randomSofa(rng_));
    for (int i = 1 + rng_.below(2); i > 0; --i) placeAtWall(randomPlant(rng_));
    placeAtWall(randomFloorLamp(rng_));
    if (rng_.chance(0.5)) placeInMiddle(randomArmchair(rng_));
  }

  void decorate() {
    for (Wall& wall : walls_) hangPictures(wall);
    const double x = rng_.uniform(0.35, 0.65) * width_, y = rng_.uniform(0.35, 0.65) * depth_;
    const auto lamp = brightMaterial(shapes_, rng_);
    const double drop = rng_.uniform(0.25, 0.45);
    shapes_.at({x, y, height_ - drop}).frustum(0.012, 0.012, drop, lamp);
    if (rng_.chance(0.5))
      shapes_.at({x, y, height_ - drop - 0.1}).ellipsoid({0.18, 0.18, 0.18}, lamp);
    else
      shapes_.at({x, y, height_ - drop - 0.16}).frustum(0.28, 0.1, 0.2, lamp);
    if (rng_.chance(0.5)) {  // ceiling beams
      const auto wood = woodMaterial(shapes_, rng_);
      const int beams = 2 + rng_.below(3);
      for (int i = 0; i < beams; ++i) {
        const double at = (i + 0.5) / beams * width_;
        shapes_.box({at - 0.07, 0, height_ - 0.16}, {at + 0.07, depth_, height_}, wood);
      }
    }
    const double rug_w = rng_.uniform(0.3, 0.5) * width_, rug_d = rng_.uniform(0.3, 0.5) * depth_;
    shapes_.at({rng_.uniform(0.4, 0.6) * width_, rng_.uniform(0.4, 0.6) * depth_, 0}, rng_.uniform(-0.3, 0.3))
        .box({rug_w, rug_d, 0.015}, clothMaterial(shapes_, rng_));
  }

  void hangPictures(Wall& wall) {
    for (int attempt = 0; attempt < 10; ++attempt) {
      const double w = rng_.uniform(0.3, 0.9), h = rng_.uniform(0.3, 0.7);
      const double x = rng_.uniform(0.2, std::max(0.3, wall.length - w - 0.2)), z = rng_.uniform(1.25, 1.6);
      const Span span{x, x + w, z, z + h};
      if (x + w > wall.length - 0.15 || z + h > height_ - 0.15 || !wall.isFree(span, 0.15)) continue;
      wall.taken.push_back(span);
      const ShapeBuilder s = onWall(wall);
      if (rng_.chance(0.3)) {  // a wall shelf instead
        s.box({x, -0.2, z}, {x + w, 0, z + 0.025}, woodMaterial(s, rng_));
        addClutter(s.at({x + w / 2, -0.1, z + 0.025}), w, 0.16, 4, rng_);
        continue;
      }
      const auto frame = woodMaterial(s, rng_), image = clothMaterial(s, rng_);
      const double border = rng_.uniform(0.03, 0.06);
      s.box({x, -0.015, z}, {x + w, 0, z + h}, image);
      s.box({x, -0.04, z}, {x + border, 0, z + h}, frame);
      s.box({x + w - border, -0.04, z}, {x + w, 0, z + h}, frame);
      s.box({x, -0.04, z}, {x + w, 0, z + border}, frame);
      s.box({x, -0.04, z + h - border}, {x + w, 0, z + h}, frame);
    }
  }

  Rng rng_;
  Scene scene_;
  ShapeBuilder shapes_;
  double width_, depth_, height_;
  std::vector<Wall> walls_;
  std::vector<Rectangle> footprints_;
};

}  // namespace

Scene makeRoom(std::uint64_t seed) {
  return RoomMaker(seed).make();
}

}  // namespace rosefusion
