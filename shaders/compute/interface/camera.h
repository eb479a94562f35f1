// The pinhole camera as shaders see it.
#ifndef ROSEFUSION_INTERFACE_CAMERA_H
#define ROSEFUSION_INTERFACE_CAMERA_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

struct CameraIntrinsics {
  vec4 focal_centre;  // fx, fy, cx, cy in pixels
  ivec4 size;         // width, height; z, w: unused
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
