// One ray per pixel, for whatever is to be known of the surface it meets.
#pragma once
#include <algorithm>

#include "host/core/camera.h"
#include "host/synth/tracer.h"

namespace rosefusion {

/// Calls pixel(row, column, hit, direction) for every pixel of rows [first_row, end_row), from one thread;
/// directions have unit length along the optical axis, so that hit.distance is the depth.
template <typename Pixel>
void castRows(const Tracer& tracer, const Intrinsics& k, const Pose& pose, double longest, int first_row,
              int end_row, const Pixel& pixel) {
  const Eigen::Matrix3d rotation = pose.linear();
  const Eigen::Vector3d origin = pose.translation();
  Eigen::Matrix<double, 3, 4> directions;
  Tracer::Hit hits[4];
  for (int v = first_row; v < end_row; ++v)
    for (int u = 0; u < k.width; u += 4) {
      for (int i = 0; i < 4; ++i)
        directions.col(i) = rotation * k.unproject(std::min(u + i, k.width - 1), v, 1);
      tracer.cast4(origin, directions, longest, hits);
      for (int i = 0; i < 4 && u + i < k.width; ++i)
        pixel(v, u + i, hits[i], Eigen::Vector3d(directions.col(i)));
    }
}

template <typename Pixel>
void castImage(const Tracer& tracer, const Intrinsics& k, const Pose& pose, double longest,
               const Pixel& pixel) {
  castRows(tracer, k, pose, longest, 0, k.height, pixel);
}

}  // namespace rosefusion
