// Frames of a map that may have to be fused again elsewhere, within a limit of memory.
#pragma once
#include <vector>

#include "host/core/frame.h"
#include "host/settings/settings.h"

namespace rosefusion {

/// Copies of the images of frames that are loops.keyframe_shift or keyframe_turn apart; beyond
/// loops.memory_mb every second of them goes, and they lie twice as far apart from then on. One thread.
class KeptFrames {
 public:
  struct Kept {
    std::size_t number = 0;  ///< its pose in the map's trajectory
    Frame frame;
  };

  explicit KeptFrames(const LoopSettings& settings)
      : shift_(settings.keyframe_shift),
        turn_(settings.keyframe_turn),
        limit_bytes_(settings.memory_mb << 20) {}

  /// A frame that was fused at this pose.
  void offer(const Frame& frame, const Pose& world_from_camera, std::size_t number);
  /// One that another map kept.
  void add(Kept kept);
  /// A pose was inserted into the trajectory with this number.
  void renumber(std::size_t inserted);
  const std::vector<Kept>& all() const { return all_; }
  void clear();

 private:
  double shift_, turn_;
  std::uint64_t limit_bytes_, bytes_ = 0;
  std::vector<Kept> all_;
  Pose last_ = Pose::Identity();
};

}  // namespace rosefusion
