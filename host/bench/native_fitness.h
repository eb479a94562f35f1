// The fitness pass as a tuned multithreaded C++ loop: what the device's pass is measured against.
#pragma once
#include <cstdint>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "engine/passes/fitness.h"
#include "host/bench/native_volume.h"

namespace rosefusion {

/// Particles in vector lanes, Kahan-compensated, nearest voxel, spread over `threads` threads. `templates` as
/// in FitnessPass; `points`: camera frame, metres. Mean loss per particle; -1 without points.
std::vector<float> nativeLosses(const NativeVolume& volume, std::span<const glm::vec4> templates,
                                std::span<const glm::vec4> points, const SwarmPlacement& swarm, Loss loss,
                                int threads);

}  // namespace rosefusion
