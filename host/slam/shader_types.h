// Host types as the shaders' structs.
#pragma once
#include <glm/mat4x4.hpp>

#include "engine/sensor_noise.h"
#include "host/core/camera.h"
#include "host/settings/settings.h"
#include "shaders/compute/interface/camera.h"

namespace rosefusion {

inline glm::mat4 toShader(const Eigen::Matrix4d& matrix) {
  glm::mat4 out;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) out[column][row] = static_cast<float>(matrix(row, column));
  return out;
}
inline glm::mat4 toShader(const Pose& pose) {
  return toShader(pose.matrix());
}

inline shader::CameraIntrinsics toShader(const Intrinsics& k) {
  return {glm::vec4(k.fx, k.fy, k.cx, k.cy), glm::ivec4(k.width, k.height, 0, 0)};
}

inline SensorNoise toShader(const DepthSettings& depth) {
  return {static_cast<float>(depth.noise_floor), static_cast<float>(depth.noise_growth),
          static_cast<float>(depth.bias_growth)};
}

}  // namespace rosefusion
