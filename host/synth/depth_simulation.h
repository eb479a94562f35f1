// Depth images as simulated cameras measure them.
#pragma once
#include <functional>
#include <opencv2/core/mat.hpp>

#include "host/core/camera.h"
#include "host/synth/random.h"
#include "host/synth/sensors.h"
#include "host/synth/tracer.h"

namespace rosefusion {

/// world_from_camera of the depth camera so many seconds after the frame's moment (before: negative).
using PoseAt = std::function<Pose(double)>;

/// All return CV_32FC1 in metres along the optical axis of the depth camera, of sensor.depth's size; 0:
/// invalid. Random numbers come from `rng` alone.
cv::Mat measureStereo(const Sensor& sensor, const Tracer& tracer, const PoseAt& pose_at, Rng& rng);
cv::Mat measureStructuredLight(const Sensor& sensor, const Tracer& tracer, const PoseAt& pose_at, Rng& rng);
cv::Mat measureTimeOfFlight(const Sensor& sensor, const Tracer& tracer, const PoseAt& pose_at, Rng& rng);
cv::Mat measurePhoneLidar(const Sensor& sensor, const Tracer& tracer, const PoseAt& pose_at, Rng& rng);

/// The one that sensor.principle names, carried onto the image that sensor.registration names, in whole
/// millimetres. kNoise is not among them.
cv::Mat simulateDepth(const Sensor& sensor, const Tracer& tracer, const PoseAt& pose_at, Rng& rng);

/// Carries each depth onto the image of another camera, the nearest one where several fall onto a pixel.
cv::Mat registerDepth(const cv::Mat& depth, const Intrinsics& from, const Intrinsics& to,
                      const Pose& to_from_from, Registration registration);

}  // namespace rosefusion
