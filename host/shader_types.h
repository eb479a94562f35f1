// Host types as the shaders' structs.
#pragma once
#include <glm/mat4x4.hpp>

#include "engine/sensor_noise.h"
#include "host/camera.h"
#include "host/settings.h"
#include "shaders/compute/interface/camera.h"

namespace rosefusion {

inline glm::mat4 toShader(const Pose& pose) {
  glm::mat4 out(1);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) out[column][row] = static_cast<float>(pose.matrix()(row, column));
  return out;
}

inline shader::CameraIntrinsics toShader(const Intrinsics& k) {
  return {glm::vec4(k.fx, k.fy, k.cx, k.cy), glm::ivec4(k.width, k.height, 0, 0)};
}

inline SensorNoise toShader(const DepthSettings& depth) {
  return {static_cast<float>(depth.noise_floor), static_cast<float>(depth.noise_growth)};
}

}  // namespace rosefusion
