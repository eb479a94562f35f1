#include "host/bench/native_preprocess.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/bench/native_loop.h"
#include "shaders/compute/interface/farthest.h"
#include "shaders/compute/interface/footprint.h"
#include "shaders/compute/interface/preprocess.h"

namespace rosefusion {
namespace {

using shader::kEdgeReach;
using shader::kFarthestTile;
using shader::kFootprintLevels;
using shader::kFootprintSide;

constexpr int kBand = kFootprintSide << (kFootprintLevels - 1);  // rows that are worked on together
constexpr int kRows = kBand + 2 * kEdgeReach;
constexpr float kNearest = 0.4f;   // metres, from where on the noise grows
constexpr float kDeviations = 4;   // of the sum of squares around a plane: more is not noise
constexpr float kLeastPixels = 3;  // more of them are needed for a plane
static_assert(kBand % kFarthestTile == 0);

/// Of each cell in a row of them: the pixels' number, means of column u, row v and inverse depth q, and sums
/// of products of the deviations; then the plane through them.
struct CellRow {
  std::vector<float> n, u, v, q, uu, uv, vv, qq, uq, vq;
  std::vector<float> slope_u, slope_v, det;
  std::vector<std::int32_t> whole, covered;  ///< the pixels lie on the plane; a voxel covers the cell

  void resize(std::size_t cells) {
    for (auto* numbers : {&n, &u, &v, &q, &uu, &uv, &vv, &qq, &uq, &vq, &slope_u, &slope_v, &det})
      numbers->resize(cells);
    whole.resize(cells);
    covered.resize(cells);
  }
};

/// A band of the image, with kEdgeReach rows and columns more at each side, and columns up to a whole cell.
struct Band {
  int columns = 0, stride = 0;
  std::vector<float> z, q;  ///< all rows: depths within the range and their inverse, 0 where invalid
  std::vector<float> own;   ///< the band's rows and columns, edges left out
  std::vector<float> own_q;
  std::array<std::vector<CellRow>, kFootprintLevels> levels;
  CellRow chosen;  ///< of a row of the finest cells: those that are used

  explicit Band(int width)
      : columns((width + kBand - 1) / kBand * kBand),
        stride(columns + 2 * kEdgeReach),
        z(std::size_t(kRows) * stride),
        q(z.size()),
        own(std::size_t(kBand) * columns),
        own_q(own.size()) {
    for (int level = 0; level < kFootprintLevels; ++level) {
      levels[level].resize(kBand / (kFootprintSide << level));
      for (CellRow& row : levels[level]) row.resize(columns / (kFootprintSide << level));
    }
    chosen.resize(columns / kFootprintSide);
  }
};

ROSEFUSION_INLINE float deviationAt(float floor, float growth, float z) {
  const float beyond = z > kNearest ? z - kNearest : 0.0f;
  return floor + growth * beyond * beyond;
}

ROSEFUSION_INLINE void toMetres(const NativePreprocessing& how, const std::uint16_t* __restrict raw,
                                float* __restrict z, float* __restrict q) {
  const float unit = how.metres_per_unit, least = how.min_depth, most = how.max_depth;
  const int width = how.camera.size.x;
  ROSEFUSION_LANES
  for (int x = 0; x < width; ++x) {
    const std::int32_t value = raw[x];
    const float depth = static_cast<float>(value) * unit;
    const bool valid = (value != 0) & (value != 65535) & (depth >= least) & (depth <= most);
    z[x] = valid ? depth : 0.0f;
    q[x] = valid ? 1 / depth : 0.0f;
  }
}

/// A row of the band, pixels at edges left out. `q` and those two rows above and below begin at column 0.
ROSEFUSION_INLINE void withoutEdges(const NativePreprocessing& how, const float* __restrict z,
                                    const float* __restrict q, const float* __restrict above,
                                    const float* __restrict below, float* __restrict own,
                                    float* __restrict own_q) {
  const int width = how.camera.size.x;
  const float sigmas = how.edge_sigmas, floor = how.noise.floor, growth = how.noise.growth;
  const bool asked = sigmas > 0;
  ROSEFUSION_LANES
  for (int x = 0; x < width; ++x) {
    const float limit = sigmas * deviationAt(floor, growth, z[x]), square = z[x] * z[x];
    const float left = q[x - kEdgeReach], right = q[x + kEdgeReach], twice = 2 * q[x];
    const bool bends_along = (left > 0) & (right > 0) & (std::fabs(left + right - twice) * square > limit);
    const bool bends_down =
        (above[x] > 0) & (below[x] > 0) & (std::fabs(above[x] + below[x] - twice) * square > limit);
    const bool kept = !(asked & (bends_along | bends_down));
    own[x] = kept ? z[x] : 0.0f;
    own_q[x] = kept ? q[x] : 0.0f;
  }
}

/// The finest cells of a row; `q`: their rows of pixels, `stride` apart, the first one being row `top`.
ROSEFUSION_INLINE void sumPixels(const float* __restrict q, int stride, int top, CellRow& row) {
  const int cells = static_cast<int>(row.n.size());
  float *__restrict n = row.n.data(), *__restrict u = row.u.data(), *__restrict v = row.v.data(),
        *__restrict mean = row.q.data(), *__restrict uu = row.uu.data(), *__restrict uv = row.uv.data(),
        *__restrict vv = row.vv.data(), *__restrict qq = row.qq.data(), *__restrict uq = row.uq.data(),
        *__restrict vq = row.vq.data();
  ROSEFUSION_LANES
  for (int cell = 0; cell < cells; ++cell) {
    float count = 0, du = 0, dv = 0, dq = 0;  // from the cell's first pixel
    ROSEFUSION_UNROLL
    for (int j = 0; j < kFootprintSide; ++j) {
      ROSEFUSION_UNROLL
      for (int i = 0; i < kFootprintSide; ++i) {
        const float value = q[j * stride + kFootprintSide * cell + i], one = value > 0 ? 1.0f : 0.0f;
        count += one;
        du += one * static_cast<float>(i);
        dv += one * static_cast<float>(j);
        dq += value;
      }
    }
    const float share = count > 0 ? 1 / count : 0.0f;
    du *= share;
    dv *= share;
    dq *= share;
    float s_uu = 0, s_uv = 0, s_vv = 0, s_qq = 0, s_uq = 0, s_vq = 0;
    ROSEFUSION_UNROLL
    for (int j = 0; j < kFootprintSide; ++j) {
      ROSEFUSION_UNROLL
      for (int i = 0; i < kFootprintSide; ++i) {
        const float value = q[j * stride + kFootprintSide * cell + i], one = value > 0 ? 1.0f : 0.0f;
        const float a = one * (static_cast<float>(i) - du), b = one * (static_cast<float>(j) - dv),
                    c = one * (value - dq);
        s_uu += a * a;
        s_uv += a * b;
        s_vv += b * b;
        s_qq += c * c;
        s_uq += a * c;
        s_vq += b * c;
      }
    }
    n[cell] = count;
    u[cell] = static_cast<float>(kFootprintSide * cell) + du;
    v[cell] = static_cast<float>(top) + dv;
    mean[cell] = dq;
    uu[cell] = s_uu;
    uv[cell] = s_uv;
    vv[cell] = s_vv;
    qq[cell] = s_qq;
    uq[cell] = s_uq;
    vq[cell] = s_vq;
  }
}

/// A row of cells from the two rows of half their size.
ROSEFUSION_INLINE void sumCells(const CellRow& upper, const CellRow& lower, CellRow& row) {
  const int cells = static_cast<int>(row.n.size());
  ROSEFUSION_LANES
  for (int cell = 0; cell < cells; ++cell) {
    float n = 0, u = 0, v = 0, q = 0;
    ROSEFUSION_UNROLL
    for (int i = 0; i < 4; ++i) {
      const CellRow& from = i < 2 ? upper : lower;
      const int at = 2 * cell + (i & 1);
      n += from.n[at];
      u += from.n[at] * from.u[at];
      v += from.n[at] * from.v[at];
      q += from.n[at] * from.q[at];
    }
    const float share = n > 0 ? 1 / n : 0.0f;
    u *= share;
    v *= share;
    q *= share;
    float uu = 0, uv = 0, vv = 0, qq = 0, uq = 0, vq = 0;
    ROSEFUSION_UNROLL
    for (int i = 0; i < 4; ++i) {
      const CellRow& from = i < 2 ? upper : lower;
      const int at = 2 * cell + (i & 1);
      const float w = from.n[at], a = from.u[at] - u, b = from.v[at] - v, c = from.q[at] - q;
      uu += from.uu[at] + w * a * a;
      uv += from.uv[at] + w * a * b;
      vv += from.vv[at] + w * b * b;
      qq += from.qq[at] + w * c * c;
      uq += from.uq[at] + w * a * c;
      vq += from.vq[at] + w * b * c;
    }
    row.n[cell] = n;
    row.u[cell] = u;
    row.v[cell] = v;
    row.q[cell] = q;
    row.uu[cell] = uu;
    row.uv[cell] = uv;
    row.vv[cell] = vv;
    row.qq[cell] = qq;
    row.uq[cell] = uq;
    row.vq[cell] = vq;
  }
}

/// The planes, and which of them hold: of the finest cells (`side` is kFootprintSide) any that is flat, of
/// the others those that a voxel covers.
ROSEFUSION_INLINE void fitPlanes(const NativePreprocessing& how, int side, CellRow& row) {
  const int cells = static_cast<int>(row.n.size());
  const float pixels_per_inverse = how.voxel_size * how.camera.focal_centre.x,
              size = static_cast<float>(side);
  const float floor = how.noise.floor, growth = how.noise.growth;
  const std::int32_t finest = side == kFootprintSide;
  const float *__restrict n = row.n.data(), *__restrict q = row.q.data(), *__restrict uu = row.uu.data(),
              *__restrict uv = row.uv.data(), *__restrict vv = row.vv.data(), *__restrict qq = row.qq.data(),
              *__restrict uq = row.uq.data(), *__restrict vq = row.vq.data();
  float *__restrict slope_u = row.slope_u.data(), *__restrict slope_v = row.slope_v.data(),
        *__restrict dets = row.det.data();
  std::int32_t* __restrict whole = row.whole.data(), * __restrict covers = row.covered.data();
  ROSEFUSION_LANES
  for (int cell = 0; cell < cells; ++cell) {
    const float det = uu[cell] * vv[cell] - uv[cell] * uv[cell], inverse = 1 / det;
    const float a = (vv[cell] * uq[cell] - uv[cell] * vq[cell]) * inverse,
                b = (uu[cell] * vq[cell] - uv[cell] * uq[cell]) * inverse;
    const float rest = qq[cell] - (a * uq[cell] + b * vq[cell]), squares = rest > 0 ? rest : 0.0f;
    const float deviation = deviationAt(floor, growth, 1 / q[cell]) * q[cell] * q[cell];
    const float freedom = n[cell] - kLeastPixels;
    const float allowed = deviation * deviation * (freedom + kDeviations * std::sqrt(2 * freedom));
    const std::int32_t covered = size <= pixels_per_inverse * q[cell];
    slope_u[cell] = a;
    slope_v[cell] = b;
    dets[cell] = det;
    covers[cell] = covered;
    whole[cell] = (n[cell] > kLeastPixels) & (covered | finest) & (det > 0) & (squares <= allowed);
  }
}

/// For each of the finest cells in row `row` of the band the coarsest plane that holds.
ROSEFUSION_INLINE void choosePlanes(Band& band, int row) {
  CellRow& out = band.chosen;
  const int cells = static_cast<int>(out.n.size());
  for (int cell = 0; cell < cells; ++cell) {
    int level = kFootprintLevels - 1;
    while (level > 0 && !band.levels[level][row >> level].whole[cell >> level]) --level;
    const CellRow& from = band.levels[level][row >> level];
    const int at = cell >> level;
    out.whole[cell] = from.whole[at];
    out.covered[cell] = from.covered[at];
    out.n[cell] = from.n[at];
    out.u[cell] = from.u[at];
    out.v[cell] = from.v[at];
    out.q[cell] = from.q[at];
    out.uu[cell] = from.uu[at];
    out.uv[cell] = from.uv[at];
    out.vv[cell] = from.vv[at];
    out.slope_u[cell] = from.slope_u[at];
    out.slope_v[cell] = from.slope_v[at];
    out.det[cell] = from.det[at];
  }
}

/// Row `y` of the image.
ROSEFUSION_INLINE void writeRow(const NativePreprocessing& how, int y, bool planes, const CellRow& c,
                                const std::uint16_t* __restrict raw, const float* __restrict own,
                                float* __restrict depth, glm::vec4* __restrict points) {
  const int width = how.camera.size.x;
  const float least = how.min_depth, most = how.max_depth;
  if (planes) ROSEFUSION_LANES
  for (int x = 0; x < width; ++x) {
    const int cell = x / kFootprintSide;
    const bool hole = (raw[x] == 0) | (raw[x] == 65535);
    const float du = static_cast<float>(x) - c.u[cell], dv = static_cast<float>(y) - c.v[cell];
    const float q = c.q[cell] + c.slope_u[cell] * du + c.slope_v[cell] * dv;
    const float lever =
        1 / c.n[cell] +
        (c.vv[cell] * du * du - 2 * c.uv[cell] * du * dv + c.uu[cell] * dv * dv) / c.det[cell];
    const bool used = (c.whole[cell] != 0) & (q * most >= 1) & (q * least <= 1) & (lever <= 1) &
                      (hole | ((own[x] > 0) & (c.covered[cell] != 0)));
    depth[x] = used ? 1 / q : own[x];
  }
  else std::copy(own, own + width, depth);
  const float across = 1 / how.camera.focal_centre.x, middle = how.camera.focal_centre.z,
              down = (static_cast<float>(y) - how.camera.focal_centre.w) / how.camera.focal_centre.y;
  ROSEFUSION_LANES
  for (int x = 0; x < width; ++x) {
    const float z = depth[x];
    points[x] = {(static_cast<float>(x) - middle) * across * z, down * z, z, z > 0 ? 1.0f : 0.0f};
  }
}

ROSEFUSION_INLINE void preprocessBand(const NativePreprocessing& how, int number, const std::uint16_t* raw,
                                      NativeFrame& frame, Band& band) {
  const int width = how.camera.size.x, height = how.camera.size.y, top = number * kBand;
  for (int row = 0; row < kRows; ++row) {
    const int y = top + row - kEdgeReach;
    float *z = &band.z[std::size_t(row) * band.stride + kEdgeReach], *q = &band.q[z - band.z.data()];
    if (y >= 0 && y < height)
      toMetres(how, raw + std::ptrdiff_t(y) * width, z, q);
    else {
      std::fill(z, z + width, 0.0f);
      std::fill(q, q + width, 0.0f);
    }
  }
  for (int row = 0; row < kBand; ++row) {
    const std::size_t at = std::size_t(row + kEdgeReach) * band.stride + kEdgeReach;
    const std::size_t reach = std::size_t(kEdgeReach) * band.stride, to = std::size_t(row) * band.columns;
    withoutEdges(how, &band.z[at], &band.q[at], &band.q[at - reach], &band.q[at + reach], &band.own[to],
                 &band.own_q[to]);
  }
  const bool planes = how.voxel_size > 0;
  for (int level = 0; planes && level < kFootprintLevels; ++level) {
    const int side = kFootprintSide << level;
    for (int row = 0; row < kBand / side; ++row) {
      CellRow& cells = band.levels[level][row];
      if (level == 0)
        sumPixels(&band.own_q[std::size_t(row) * side * band.columns], band.columns, top + row * side, cells);
      else
        sumCells(band.levels[level - 1][2 * row], band.levels[level - 1][2 * row + 1], cells);
      fitPlanes(how, side, cells);
    }
  }
  for (int y = top; y < std::min(top + kBand, height); ++y) {
    if (planes && y % kFootprintSide == 0) choosePlanes(band, (y - top) / kFootprintSide);
    const std::size_t at = std::size_t(y) * width;
    writeRow(how, y, planes, band.chosen, raw + at, &band.own[std::size_t(y - top) * band.columns],
             &frame.depth[at], &frame.points[at]);
  }
  const int tiles = (width + kFarthestTile - 1) / kFarthestTile;
  for (int y = top; y < std::min(top + kBand, height); ++y) {
    float* tile = &frame.tiles[std::size_t(y / kFarthestTile) * tiles];
    for (int i = 0; i < tiles; ++i) {
      float farthest = y % kFarthestTile == 0 ? 0.0f : tile[i];
      for (int x = i * kFarthestTile; x < std::min((i + 1) * kFarthestTile, width); ++x)
        farthest = std::max(farthest, frame.depth[std::size_t(y) * width + x]);
      tile[i] = farthest;
    }
  }
}

ROSEFUSION_NATIVE(preprocessOne, preprocessBand)

}  // namespace

void nativePreprocess(const NativePreprocessing& how, std::span<const std::uint16_t> raw, NativeFrame& frame,
                      int threads) {
  const int width = how.camera.size.x, height = how.camera.size.y;
  const auto tiles = [](int pixels) { return std::size_t(pixels + kFarthestTile - 1) / kFarthestTile; };
  frame.depth.resize(raw.size());
  frame.points.resize(raw.size());
  frame.tiles.resize(tiles(width) * tiles(height));
  inParallel(static_cast<std::uint32_t>((height + kBand - 1) / kBand), threads, [&](std::uint32_t number) {
    thread_local Band band(0);
    if (band.columns < width || band.columns >= width + kBand) band = Band(width);
    preprocessOne(how, static_cast<int>(number), raw.data(), frame, band);
  });
}

}  // namespace rosefusion
