// What comparing a pass with its reference found.
#pragma once
#include <cstddef>
#include <string>

namespace rosefusion::reference {

/// Values whose outcome rounding alone decides (a voxel on the border between two pixels, say) are skipped,
/// and tests bound their share. An error is given in units of its tolerance: above 1 is a mismatch.
struct Comparison {
  std::size_t compared = 0;
  std::size_t skipped = 0;
  std::size_t mismatched = 0;
  double worst = 0;
  std::string first;  ///< the first mismatch, in words

  void add(double error_in_tolerances, const std::string& where) {
    ++compared;
    if (!(error_in_tolerances <= worst)) worst = error_in_tolerances;
    if (error_in_tolerances <= 1) return;
    if (mismatched++ == 0) first = where;
  }
};

}  // namespace rosefusion::reference
