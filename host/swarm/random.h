// Random numbers that are the same on every platform: std distributions and libm differ between them.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>

namespace rosefusion {

using Point6 = std::array<double, 6>;

/// std::mt19937_64 (whose output the standard fixes) with transforms made of + - * / sqrt only, which IEEE
/// 754 rounds identically everywhere. Build without contraction to fused multiply-add (see CMakeLists.txt).
class PortableRandom {
 public:
  explicit PortableRandom(uint64_t seed) : engine_(seed) {}

  /// Uniform in [0, 1), 53 bits.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

  /// Uniform integer in [0, count); the bias below 2^-32 for the counts used here is irrelevant.
  uint32_t below(uint32_t count) {
    return static_cast<uint32_t>(((engine_() >> 32) * static_cast<uint64_t>(count)) >> 32);
  }

  /// Uniform direction on the unit sphere of R^6, seen as C^3: the squared moduli of its three complex
  /// numbers are uniform on the simplex (the spacings of two sorted uniforms) and their phases are
  /// independent and uniform.
  Point6 direction() {
    double a = uniform();
    double b = uniform();
    if (a > b) std::swap(a, b);
    const std::array<double, 3> squared_moduli = {a, b - a, 1 - b};
    Point6 direction;
    for (size_t i = 0; i < 3; ++i) {
      double x, y, norm;
      do {
        x = 2 * uniform() - 1;
        y = 2 * uniform() - 1;
        norm = x * x + y * y;
      } while (norm > 1 || norm < 1e-12);
      const double scale = std::sqrt(squared_moduli[i] / norm);
      direction[2 * i] = x * scale;
      direction[2 * i + 1] = y * scale;
    }
    return direction;
  }

  /// Distance from the centre of a point uniform in the unit ball of R^6: u^(1/6), as the largest of six
  /// uniforms.
  double ballRadius() {
    double largest = 0;
    for (int i = 0; i < 6; ++i) largest = std::max(largest, uniform());
    return largest;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace rosefusion
