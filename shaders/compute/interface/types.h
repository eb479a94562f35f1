// Names of GLSL types for C++; every interface header includes it. Shared structs hold only mat4, vec4,
// ivec4, uvec4 and 32-bit scalars, so that std430 and C++ agree; tests compare the offsets.
#ifndef ROSEFUSION_INTERFACE_TYPES_H
#define ROSEFUSION_INTERFACE_TYPES_H
#ifdef __cplusplus
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
namespace rosefusion::shader {
using glm::ivec4;
using glm::mat4;
using glm::uvec4;
using glm::vec4;
using uint = std::uint32_t;
}  // namespace rosefusion::shader
#endif

#ifdef __cplusplus
namespace rosefusion::shader {
#endif
// Most iterations that one invocation may run, over all its loops. Mesa's llvmpipe ends loops silently after
// 65535 (LP_MAX_TGSI_LOOP_ITERATIONS), and other drivers' watchdogs end what runs for seconds.
const uint kLongestLoop = 32768u;
#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
