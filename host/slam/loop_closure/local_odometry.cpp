#include "host/slam/loop_closure/local_odometry.h"

#include <utility>

namespace rosefusion {
namespace {

constexpr double kLeastShare = 0.3;  // of the image that must read a distance, else the tracked motion counts

}  // namespace

LocalOdometry::LocalOdometry(Device& device, const Settings& settings, const Intrinsics& intrinsics,
                             const VolumeOptions& volume, Fuse fuse)
    : settings_(settings.refine),
      fuse_(std::move(fuse)),
      refiner_(device, settings, intrinsics),
      recent_(device, volume) {}

void LocalOdometry::begin(std::size_t first, std::span<const Pose> keyframes) {
  recent_.clear();
  for (std::size_t i = 0; i < keyframes.size(); ++i) fuse_(first + i, recent_, keyframes[i]);
  poses_ = {keyframes.back()};
  next_ = first + keyframes.size();
}

void LocalOdometry::step(const DeviceFrame& frame, const Pose& last_from_camera) {
  const Pose expected = poses_.back() * last_from_camera;
  // Believes all slopes: what noise alone holds slides less than motion that is carried on.
  refiner_.selectPixels(frame, settings_.pixel_stride, poses_.back(), false);
  const PoseFit fit =
      refiner_.refine(recent_, std::vector<Pose>{expected}, settings_.iterations, expected)[0];
  poses_.push_back(fit.holds(kLeastShare, settings_.least_constraint) ? fit.world_from_camera : expected);
  fuse_(next_++, recent_, poses_.back());
}

}  // namespace rosefusion
