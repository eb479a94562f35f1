// A walk around a block in a furnished hall, which comes back to where it began.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "host/core/frame.h"
#include "host/settings/settings.h"
#include "host/synth/motion.h"
#include "host/synth/noise.h"
#include "host/synth/renderer.h"
#include "host/synth/shapes.h"

namespace rosefusion::testing {

inline constexpr Intrinsics kRingCamera{160, 120, 80, 80, 79.5, 59.5};
inline constexpr double kRingRadius = 2, kRingUnits = 5000;

/// 6.4 x 6.4 m around a block of 2 x 2 m, which hides one side from the other; boxes along all walls.
inline Scene ringHall() {
  Scene scene;
  const ShapeBuilder shapes(scene, Eigen::Isometry3d::Identity());
  const auto grey = shapes.addMaterial({});
  shapes.box({-3.2, -3.2, 0}, {3.2, 3.2, 2.6}, grey);
  shapes.box({-1, -1, 0}, {1, 1, 2.6}, grey);
  Rng rng(11);
  for (int i = 0; i < 60; ++i) {
    const double angle = i * std::numbers::pi / 30, side = i % 3 ? 3.0 : 0.9;
    const double reach = side / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
    shapes.at(reach * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0), rng.uniform(0, 1.5))
        .box({rng.uniform(0.2, 0.6), rng.uniform(0.2, 0.6), rng.uniform(0.3, 2.2)}, grey);
  }
  paintVertices(scene);
  return scene;
}

/// The camera after `metres` along the circle, looking ahead and a little outwards.
inline Pose ringPose(double metres) {
  const double angle = metres / kRingRadius;
  const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0), ahead(-std::sin(angle), std::cos(angle), 0);
  const double height = 1.4 + 0.1 * std::sin(5 * angle);
  return Eigen::Translation3d(kRingRadius * out + height * Eigen::Vector3d::UnitZ()) *
         lookAlong(ahead + 0.5 * out - 0.2 * Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ()) *
         Pose::Identity();
}

/// Metres that the camera has come by frame i: from rest to 3.6 m/s.
inline double ringWay(int i) {
  constexpr double kStep = 0.12, kRamp = 12;
  return i < kRamp ? kStep * i * i / (2 * kRamp) : kStep * (i - kRamp / 2);
}

/// One depth image; all depths read too far by `scale`.
inline Frame ringFrame(const Tracer& tracer, int i, double scale) {
  Frame frame;
  frame.timestamp = i / 30.0;
  Rng rng(12, static_cast<std::uint64_t>(i));
  const cv::Mat depth = addHandaNoise(renderDepth(tracer, kRingCamera, ringPose(ringWay(i))), rng);
  depth.convertTo(frame.depth, CV_16UC1, scale * kRingUnits);
  return frame;
}

inline constexpr int kRingFrames = 133;  // a lap and a fifth

/// The walk, with a part where all depths read too far: the camera believes to have come further than it has.
inline const std::vector<Frame>& ringFrames() {
  static const std::vector<Frame> frames = [] {
    // It comes and goes slowly, as drift does: what changes from one frame to the next is doubted.
    constexpr double kTooFar = 0.08;
    constexpr int kFirstScaled = 28, kScaledEnd = 83;
    const Scene scene = ringHall();
    const Tracer tracer(scene);
    std::vector<Frame> out;
    for (int i = 0; i < kRingFrames; ++i) {
      const double part = std::clamp(double(i - kFirstScaled) / (kScaledEnd - kFirstScaled), 0.0, 1.0);
      out.push_back(ringFrame(tracer, i, 1 + kTooFar * std::pow(std::sin(part * std::numbers::pi), 2)));
    }
    return out;
  }();
  return frames;
}

inline Settings ringSettings(bool loops) {
  Settings settings = loadSettings("default");
  applyAssignment(settings, "swarm.levels=1024/16 512/8 256/4");  // a frame takes milliseconds
  applyAssignment(settings, "tracking.templates_per_level=3");
  settings.volume.voxel_size = 0.03;
  settings.volume.truncation = 0.09;
  settings.loops.enabled = loops;
  return settings;
}

}  // namespace rosefusion::testing
