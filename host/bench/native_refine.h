// The refine pass as a multithreaded C++ loop: what the device's pass is measured against.
#pragma once
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "engine/passes/refine.h"
#include "host/bench/native_volume.h"

namespace rosefusion {

/// The sums at each candidate, as RefinePass::record gives them. `points`: camera frame, metres;
/// `truncation`: of the volume, metres. Points in vector lanes, their sums in single precision within a few
/// of them, in double beyond.
std::vector<RefineSums> nativeRefine(const NativeVolume& volume, float truncation,
                                     std::span<const glm::vec4> points,
                                     std::span<const shader::RefineCandidate> candidates,
                                     const shader::CameraIntrinsics& last_camera,
                                     const RefineWeights& weights, int threads);

}  // namespace rosefusion
