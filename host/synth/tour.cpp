// A closed tour: stops spread over the whole free space, visited in a short order, lap after lap.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "host/core/error.h"
#include "host/synth/motion.h"
#include "host/synth/walk.h"

namespace rosefusion {
namespace {

constexpr int kMostStops = 16;
constexpr double kArrived = 0.8;  // metres from a stop
constexpr double kDetour =
    0.95;  // a smooth flight against the way along the grid, which turns at right angles
constexpr int kMostBacktracks =
    40;  // then a stop counts as out of reach for a camera that cannot turn on the spot

/// Metres along the grid from every cell to one cell.
std::vector<float> distancesTo(const FreeSpace& space, std::size_t goal) {
  std::vector<float> distance(space.size(), -1);
  std::vector<std::size_t> queue{goal};
  distance[goal] = 0;
  for (std::size_t next = 0; next < queue.size(); ++next)
    for (const std::int64_t n : space.neighbours(queue[next]))
      if (distance[n] < 0) {
        distance[n] = distance[queue[next]] + static_cast<float>(space.cellSize());
        queue.push_back(static_cast<std::size_t>(n));
      }
  return distance;
}

struct Stops {
  std::vector<std::size_t> cells;
  std::vector<std::vector<float>> fields;  // distancesTo each
  double between(int a, int b) const { return fields[a][cells[b]]; }
};

/// Cells far apart from each other and with room to turn: each new one is the farthest from all before it.
Stops spreadStops(const FreeSpace& space, int count, Rng& rng) {
  Stops stops;
  std::vector<std::size_t> roomy;
  for (const double wanted : {0.7, 0.5, kKeyClearance}) {
    for (std::size_t i = 0; i < space.size(); ++i)
      if (space.isClear(space.cell(i), wanted)) roomy.push_back(i);
    if (roomy.size() > 30) break;
  }
  std::size_t next = roomy[rng.below(static_cast<int>(roomy.size()))];
  std::vector<float> nearest(space.size(), std::numeric_limits<float>::max());
  while (static_cast<int>(stops.cells.size()) < count) {
    stops.cells.push_back(next);
    stops.fields.push_back(distancesTo(space, next));
    for (std::size_t i = 0; i < nearest.size(); ++i)
      nearest[i] = std::min(nearest[i], stops.fields.back()[i]);
    next = *std::max_element(roomy.begin(), roomy.end(),
                             [&](auto a, auto b) { return nearest[a] < nearest[b]; });
    if (nearest[next] < 1.2) break;
  }
  return stops;
}

double lapLength(const Stops& stops, const std::vector<int>& order) {
  double length = 0;
  for (std::size_t i = 0; i < order.size(); ++i)
    length += stops.between(order[i], order[(i + 1) % order.size()]);
  return length * kDetour;
}

/// A short round trip: 2-opt from the order in which the stops were found.
std::vector<int> shortOrder(const Stops& stops, int count) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  double length = lapLength(stops, order);
  for (bool improved = true; improved;) {
    improved = false;
    for (int i = 1; i + 1 < count; ++i)
      for (int j = i + 1; j < count; ++j) {
        std::reverse(order.begin() + i, order.begin() + j + 1);
        const double shorter = lapLength(stops, order);
        if (shorter < length - 1e-6) {
          length = shorter;
          improved = true;
        } else {
          std::reverse(order.begin() + i, order.begin() + j + 1);
        }
      }
  }
  return order;
}

}  // namespace

PositionSpline tour(const FreeSpace& space, double lap_length, int loops, Rng& rng) {
  const Stops stops = spreadStops(space, kMostStops, rng);
  if (stops.cells.size() < 3)
    throw InputError(
        "--loops: the scene is too small for a tour; leave the option out or give a larger mesh.");
  std::vector<int> order = shortOrder(stops, 3);
  for (int count = 4; count <= static_cast<int>(stops.cells.size()) && lapLength(stops, order) < lap_length;
       ++count)
    order = shortOrder(stops, count);

  for (int attempt = 0; attempt < 30; ++attempt) {
    Walk walk(space, rng);
    if (!walk.start()) continue;
    int backtracks = 0, skipped = 0;
    for (std::size_t leg = 0;
         walk.spline().length() < lap_length * loops && skipped < 3 * int(order.size());) {
      const std::vector<float>& field = stops.fields[order[leg % order.size()]];
      const auto away = [&](const Eigen::Vector3d& p) {
        const std::int64_t cell = space.find(p);
        return cell < 0 ? 1e6 : double(field[cell]);
      };
      const double from = away(walk.spline().keys().back());
      if (from < kArrived) {
        ++leg;
        backtracks = 0;
        continue;
      }
      if (walk.extend([&](const Eigen::Vector3d& p) { return 4 * (from - away(p)); })) continue;
      walk.backtrack(3);
      if (++backtracks > kMostBacktracks) {
        ++leg;
        ++skipped;
        backtracks = 0;
      }
    }
    if (walk.spline().length() >= lap_length * loops) return walk.take();
  }
  throw InputError(
      "--loops: no tour without sharp turns was found; leave the option out or give a larger mesh.");
}

}  // namespace rosefusion
