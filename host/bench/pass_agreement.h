// Whether a pass computes what its native loop does: shares of the results that differ by more than rounding.
#pragma once
#include <glm/vec4.hpp>
#include <span>
#include <string>

#include "engine/passes/refine.h"
#include "host/bench/native_preprocess.h"
#include "host/bench/native_raycast.h"
#include "host/bench/native_volume.h"

namespace rosefusion {

/// What rounding may do: where it decides whether a pixel is an edge or lies on a plane, depths and points
/// differ by more than their tolerance. Voxels see another pixel beside it, and rays another candidate at the
/// rim of what they hit.
inline constexpr double kPixelsApart = 2e-3, kVoxelsApart = 2e-3, kRaysApart = 0.01;

/// Of the preprocessed frame: depth per pixel, points, and the farthest depth of each tile, all metres.
double pixelsApart(std::span<const float> depth, std::span<const glm::vec4> points,
                   std::span<const float> farthest, const NativeFrame& native);
/// `max_weight`: of the volume.
double voxelsApart(const NativeVolume& device, const NativeVolume& native, float max_weight);
/// One RefineSums a candidate; `huber`: metres, of the weights that both were computed with.
double sumsApart(std::span<const RefineSums> device, std::span<const RefineSums> native, float huber);
/// `surface`: two words a pixel, as RaycastPass::surface() holds them; `voxel_size`: metres.
double raysApart(std::span<const std::uint32_t> surface, std::span<const std::uint32_t> preview,
                 const NativeView& native, double voxel_size);

/// Largest |device - native| that a particle's mean loss over `points` points may show: positions are rounded
/// differently, so that a few lookups next to a voxel's face read the neighbour, by at most 1 each in the
/// loss.
inline double lossTolerance(std::size_t points) {
  return 4.0 / static_cast<double>(points) + 1e-5;
}
/// The same for the mean over all particles: such lookups are rare.
inline constexpr double kMeanLossTolerance = 1e-4;
/// Largest difference. Throws std::runtime_error, naming the device, when a tolerance is passed.
double requireAgreement(const std::string& device_name, std::span<const float> device,
                        std::span<const float> native, std::size_t points);

}  // namespace rosefusion
