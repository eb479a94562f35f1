// Symmetric matrices as the passes sum them.
#pragma once
#include <Eigen/Core>

namespace rosefusion {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// From its upper triangle, row by row.
template <int kSize>
Eigen::Matrix<double, kSize, kSize> symmetric(const double* entry) {
  Eigen::Matrix<double, kSize, kSize> out;
  for (int row = 0; row < kSize; ++row)
    for (int column = row; column < kSize; ++column) out(row, column) = out(column, row) = *entry++;
  return out;
}

}  // namespace rosefusion
