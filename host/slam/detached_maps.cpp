#include "host/slam/detached_maps.h"

#include <algorithm>
#include <set>

#include "engine/error.h"

namespace rosefusion {
namespace {

constexpr int kLongLossFrames = 10;   // at least, of slow cameras and where stamps count frames
constexpr std::size_t kMostMaps = 8;  // beyond, the smallest is given up
constexpr std::size_t kAskedEvery = 5;
// Metres and radians: two maps tell the camera's motion from one frame to the next alike.
constexpr double kAlike = 0.05;

/// The frame is lost for the first map, and what it is in this one is told.
void tellOf(const DetachedMap& map, const FrameResult& here, FrameResult& result) {
  result.reason = {Reason::InDetachedMap};
  result.detached_map = map.number;
  result.detached_began_anew = here.began_anew;
  result.score = here.score;
  result.fit = here.fit;
  result.intruding = here.intruding;
}

}  // namespace

void DetachedMaps::Loss::add(TrackingStatus status, double timestamp) {
  now_ = timestamp;
  if (status == TrackingStatus::Lost) {
    if (!since_) since_ = timestamp;
    ++frames_;
  } else {
    since_.reset();
    frames_ = 0;
  }
}

bool DetachedMaps::Loss::isLong() const {
  return frames_ >= kLongLossFrames && now_ - *since_ >= kCarriedOn;
}

void DetachedMaps::giveUp() {
  maps_.clear();
  active_ = nullptr;
  device_is_full_ = true;
}

void DetachedMaps::remove(const DetachedMap& map) {
  if (active_ == &map) active_ = nullptr;
  std::erase_if(maps_, [&](const auto& one) { return one.get() == &map; });
}

bool DetachedMaps::asksFirst(const Submap& first) {
  const bool alone = active_ && std::holds_alternative<Tracking>(active_->state) &&
                     std::holds_alternative<Lost>(first.state);
  if (alone && ++unasked_ < kAskedEvery) return false;
  unasked_ = 0;
  return true;
}

void DetachedMaps::add(Submap& first, const Frame& frame, FrameResult& result) {
  loss_.add(result.status, frame.timestamp);
  const bool lost = result.status == TrackingStatus::Lost;
  if (active_) {
    const FrameResult here = follow(*active_, frame, result);
    if (!active_) return;  // the device is full
    active_loss_.add(here.status, frame.timestamp);
    if (here.status != TrackingStatus::Lost) {
      if (lost) {
        tellOf(*active_, here, result);
        lookForOthers(*active_, active_, frame, here, result);
      } else if (join(first, nullptr, result.world_from_camera, result.fused, *active_, here, result)) {
        return;
      }
    }
    if (result.fused) active_ = nullptr;  // it goes on in the first
  } else if (result.fused && !maps_.empty()) {
    lookForOthers(first, nullptr, frame, result, result);
  }
  const bool is_tentative = std::holds_alternative<Verifying>(first.state);
  if (lost && !is_tentative && loss_.isLong() && (!active_ || active_loss_.isLong())) begin(frame, result);
}

void DetachedMaps::begin(const Frame& frame, FrameResult& result) {
  if (device_is_full_) return;
  active_ = nullptr;
  if (maps_.size() == kMostMaps)
    remove(**std::min_element(maps_.begin(), maps_.end(), [](const auto& a, const auto& b) {
      return a->map.trajectory.size() < b->map.trajectory.size();
    }));
  try {
    maps_.push_back(work_.make(numbered_ + 1));
  } catch (const DeviceError& error) {
    if (error.code() != DeviceErrorCode::OutOfMemory) throw;
    device_is_full_ = true;
    return;
  }
  active_ = maps_.back().get();
  active_loss_ = {};
  const FrameResult here = follow(*active_, frame, result);
  if (!active_) return;
  if (here.status == TrackingStatus::Lost) return remove(*active_);  // nothing to begin with
  ++numbered_;
  tellOf(*active_, here, result);
}

FrameResult DetachedMaps::follow(DetachedMap& map, const Frame& frame, FrameResult& result) {
  FrameResult here;
  try {
    here = work_.follow(map, frame);
  } catch (const DeviceError& error) {
    if (error.code() != DeviceErrorCode::OutOfMemory) throw;
    device_is_full_ = true;  // the first map needs what is left
    remove(map);
    return here;
  }
  result.milliseconds.total += here.milliseconds.total;
  if (here.began_anew) {
    map.frames.clear();
    map.last_both.reset();
  }
  if (here.fused) map.frames.offer(frame, here.world_from_camera, *here.number);
  return here;
}

void DetachedMaps::lookForOthers(Submap& in, DetachedMap* detached, const Frame& frame,
                                 const FrameResult& found, FrameResult& result) {
  const std::size_t keyframes = in.map.keyframes.all().size();
  const bool is_new_keyframe = std::exchange(keyframes_, keyframes) != keyframes;
  std::vector<DetachedMap*> asked;
  for (const auto& map : maps_)
    if (map.get() != detached && std::holds_alternative<Verifying>(map->state)) asked.push_back(map.get());
  if (asked.empty() && is_new_keyframe) {
    DetachedMap* next = maps_[asked_++ % maps_.size()].get();
    if (next != detached) asked.push_back(next);
  }
  for (DetachedMap* map : asked) {
    const std::size_t maps = maps_.size();
    const FrameResult here = follow(*map, frame, result);
    if (maps_.size() < maps) return;  // the device is full, and this one gone
    if (here.status != TrackingStatus::Lost)
      join(in, detached, found.world_from_camera, found.fused, *map, here, result);
  }
}

bool DetachedMaps::contradicts(Submap& into, const DetachedMap& map, const Pose& into_from_map) const {
  double sum = 0;
  for (const KeptFrames::Kept& kept : map.frames.all())
    sum +=
        work_.violation(into, kept.frame, into_from_map * map.map.trajectory[kept.number].world_from_camera);
  return sum > intruding_share_ * static_cast<double>(map.frames.all().size());
}

bool DetachedMaps::join(Submap& into, DetachedMap* detached, const Pose& there, bool integrated,
                        DetachedMap& map, const FrameResult& here, FrameResult& result) {
  const std::optional<DetachedMap::Both> before =
      std::exchange(map.last_both, DetachedMap::Both{here.world_from_camera, there});
  if (!before || !integrated || !here.fused) return false;
  if (!areNear(before->here.inverse() * here.world_from_camera, before->there.inverse() * there, kAlike,
               kAlike))
    return false;
  const Pose into_from_map = there * here.world_from_camera.inverse();
  if (contradicts(into, map, into_from_map)) return false;
  std::set<double> known;
  for (const StampedPose& pose : into.map.trajectory) known.insert(pose.timestamp);
  std::vector<std::optional<std::size_t>> numbers;  // in `into`, of the map's poses
  for (const StampedPose& pose : map.map.trajectory) {
    numbers.emplace_back();
    if (!known.insert(pose.timestamp).second) continue;
    const StampedPose carried{pose.timestamp, into_from_map * pose.world_from_camera};
    numbers.back() = into.map.insert(carried);  // ascending, so that the ones before stay
    if (detached)
      detached->frames.renumber(*numbers.back());
    else
      result.recovered.push_back({*numbers.back(), carried, Reason::Joined});
  }
  if (!detached) result.number = into.map.trajectory.size() - 1;
  for (const KeptFrames::Kept& kept : map.frames.all()) {
    const std::optional<std::size_t> number = numbers[kept.number];
    if (!number) continue;
    work_.fuse(into, kept.frame, into.map.trajectory[*number].world_from_camera, *number);
    if (detached) detached->frames.add({*number, kept.frame});
  }
  result.joined.push_back({map.number, detached ? detached->number : 1});
  remove(map);
  return true;
}

}  // namespace rosefusion
