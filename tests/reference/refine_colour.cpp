#include "tests/reference/refine_colour.h"

#include <array>
#include <cmath>

#include "tests/reference/spline.h"

namespace rosefusion::reference {
namespace {

using ColourSums = Eigen::Matrix<double, kRefineColourSums, 1>;

double luminance(std::uint32_t rgb, double green) {
  return (0.299 * (rgb & 0xFF) + green * (rgb >> 8 & 0xFF) + 0.114 * (rgb >> 16 & 0xFF)) / 255;
}

double tent(double t) {
  return std::max(0.0, 1 - std::abs(t));
}

struct ColourReading {
  double value = 0;                                    ///< trilinear
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  ///< of the spline, per voxel
};

/// Nothing where one of the 27 voxels has no colour.
std::optional<ColourReading> read(const VoxelColours& colours, const Eigen::Vector3d& position) {
  const Eigen::Vector3i middle = position.array().floor().cast<int>();
  ColourReading out;
  for (int i = 0; i < 27; ++i) {
    const Eigen::Vector3i voxel = middle + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    const auto stored = colours.luminanceAt(voxel);
    if (!stored) return {};
    const Eigen::Vector3d t = position - (voxel.cast<double>().array() + 0.5).matrix();
    out.value += *stored * tent(t.x()) * tent(t.y()) * tent(t.z());
    for (int axis = 0; axis < 3; ++axis)
      out.gradient[axis] +=
          *stored * splineSlope(t[axis]) * spline(t[(axis + 1) % 3]) * spline(t[(axis + 2) % 3]);
  }
  return out;
}

/// What a point adds; see refine.cpp.
ColourSums terms(const VoxelColours& colours, const Eigen::Vector3d& position, const Eigen::Vector3d& arm,
                 double pixel, const ColourModel& model, ColourSums* size) {
  ColourSums out = ColourSums::Zero(), bound = ColourSums::Zero();
  if (const auto reading = read(colours, position)) {
    const double residual = model.gain * reading->value - pixel;
    // The gradient's 27 products are of numbers up to 1, however small it is itself.
    const double roundness = std::max(reading->gradient.norm(), 0.05) * model.gain / colours.voxelSize();
    const Eigen::Vector3d slope = reading->gradient * model.gain / colours.voxelSize();
    Eigen::Matrix<double, 7, 1> jacobian, length;
    jacobian << slope, model.turn_sense * arm.cross(slope), reading->value;
    length << Eigen::Vector3d::Constant(roundness), Eigen::Vector3d::Constant(roundness * arm.norm()), 1;
    const double a = std::abs(residual), weight = a > model.huber ? model.huber / a : 1;
    int entry = 0;
    for (int row = 0; row < 7; ++row)
      for (int column = row; column < 7; ++column, ++entry) {
        out[entry] = weight * jacobian[row] * jacobian[column];
        bound[entry] = weight * length[row] * length[column];
      }
    // A residual is the difference of two numbers up to 1.
    out.segment<7>(28) = weight * residual * jacobian;
    bound.segment<7>(28) = weight * std::max(a, 0.05) * length;
    out[35] = a < model.huber ? a * a / 2 : model.huber * (a - model.huber / 2);
    bound[35] = model.huber * std::max(a, 0.05);
    out[36] = bound[36] = 1;
  }
  if (size) *size = bound;
  return out;
}

}  // namespace

VoxelColours::VoxelColours(std::span<const Block> blocks, std::span<const std::uint32_t> colour,
                           double voxel_size)
    : voxel_size_(voxel_size) {
  for (std::size_t i = 0; i < blocks.size(); ++i) blocks_[blocks[i]] = colour.subspan(512 * i, 512);
}

std::optional<double> VoxelColours::luminanceAt(const Eigen::Vector3i& voxel) const {
  Block block;
  std::array<int, 3> local;
  for (int axis = 0; axis < 3; ++axis) {
    block[axis] = int(std::floor(voxel[axis] / 8.0));
    local[axis] = voxel[axis] - 8 * block[axis];
  }
  const auto found = blocks_.find(block);
  if (found == blocks_.end()) return {};
  const std::uint32_t word = found->second[64 * local[2] + 8 * local[1] + local[0]];
  if (word >> 24 == 0) return {};
  return luminance(word, 0.587);
}

std::vector<SumRange> refineColourSums(const VoxelColours& colours, std::span<const Eigen::Vector3d> points,
                                       const Pose& world_from_camera, const ColourModel& model) {
  std::vector<SumRange> sums(kRefineColourSums);
  for (const Eigen::Vector3d& point : points) {
    const int u = int(std::lround(model.camera.fx * point.x() / point.z() + model.camera.cx));
    const int v = int(std::lround(model.camera.fy * point.y() / point.z() + model.camera.cy));
    const double pixel = luminance(model.image[v * model.camera.width + u], model.green);
    const Eigen::Vector3d arm = world_from_camera.linear() * point;
    const Eigen::Vector3d position = (arm + world_from_camera.translation()) / colours.voxelSize();
    ColourSums size;
    ColourSums low = terms(colours, position, arm, pixel, model, &size), high = low;
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d sign(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
      const ColourSums at = terms(colours, position + kVoxelError * sign, arm, pixel, model, nullptr);
      low = low.cwiseMin(at);
      high = high.cwiseMax(at);
    }
    for (int k = 0; k < kRefineColourSums; ++k) {
      sums[k].low += low[k];
      sums[k].high += high[k];
      sums[k].size += size[k];
    }
  }
  return sums;
}

}  // namespace rosefusion::reference
