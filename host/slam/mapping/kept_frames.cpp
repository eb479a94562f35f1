#include "host/slam/mapping/kept_frames.h"

#include "host/core/se3.h"

namespace rosefusion {
namespace {

std::uint64_t bytesOf(const Frame& frame) {
  return frame.depth.total() * frame.depth.elemSize() + frame.colour.total() * frame.colour.elemSize();
}

}  // namespace

void KeptFrames::offer(const Frame& frame, const Pose& world_from_camera, std::size_t number) {
  if (!all_.empty() && areNear(last_, world_from_camera, shift_, turn_)) return;
  last_ = world_from_camera;
  // A caller may use its images again once the frame is processed.
  add({number, {frame.timestamp, frame.depth.clone(), frame.colour.clone(), {}}});
}

void KeptFrames::add(Kept kept) {
  bytes_ += bytesOf(kept.frame);
  all_.push_back(std::move(kept));
  while (bytes_ > limit_bytes_ && all_.size() > 1) {
    std::vector<Kept> fewer;
    for (std::size_t i = 0; i < all_.size(); i += 2) fewer.push_back(std::move(all_[i]));
    all_ = std::move(fewer);
    bytes_ = 0;
    for (const Kept& one : all_) bytes_ += bytesOf(one.frame);
    shift_ *= 2;
    turn_ *= 2;
  }
}

void KeptFrames::renumber(std::size_t inserted) {
  for (Kept& kept : all_) kept.number += kept.number >= inserted;
}

void KeptFrames::clear() {
  all_.clear();
  bytes_ = 0;
}

}  // namespace rosefusion
