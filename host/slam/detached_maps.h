// Maps that a lost camera goes on in, until it sees a place that connects them to the first.
#pragma once
#include <functional>
#include <memory>
#include <span>

#include "host/slam/frame_result.h"
#include "host/slam/mapping/kept_frames.h"
#include "host/slam/submap.h"

namespace rosefusion {

struct DetachedMap : Submap {
  DetachedMap(Device& device, const Settings& settings, const Intrinsics& camera, std::size_t its_number)
      : Submap(device, settings, camera), number(its_number), frames(settings.loops) {}

  std::size_t number;  ///< from 2 on; the first map is 1
  KeptFrames frames;   ///< of this map
  /// Where the last frame was that has a pose in this map and in another one.
  struct Both {
    Pose here, there;
  };
  std::optional<Both> last_both;
};

/// A camera that has been lost for a moment begins a map of its own, in which its frames are followed, every
/// fifth beside an attempt to find it in the first. Two maps are connected once one frame is integrated in
/// both, both tell its motion since the frame before alike, and neither contradicts what the other saw: the
/// frames of the later one are then fused into the earlier one, and their poses carried over. A map that the
/// camera left is looked for at keyframes. One thread.
class DetachedMaps {
 public:
  /// What the pipeline does for it. `follow`: as processFrame() in this map. `fuse`: a frame at a known pose,
  /// which may be a keyframe with this number. `violation`: share of a depth image in space that a map knows
  /// to be free.
  struct Work {
    std::function<std::unique_ptr<DetachedMap>(std::size_t number)> make;
    std::function<FrameResult(Submap&, const Frame&)> follow;
    std::function<void(Submap&, const Frame&, const Pose&, std::size_t number)> fuse;
    std::function<double(Submap&, const Frame&, const Pose&)> violation;
  };
  DetachedMaps(Work work, double intruding_share)
      : work_(std::move(work)), intruding_share_(intruding_share) {}

  /// Whether the next frame is to be looked for in the first map. While a detached map holds the camera, each
  /// search of the first is worth a dozen tracked frames, and finds nothing as long as the camera is
  /// elsewhere.
  bool asksFirst(const Submap& first);
  /// Of this frame `first`, the first map, says `result`; what detached maps say is added.
  void add(Submap& first, const Frame& frame, FrameResult& result);
  /// Those that are not connected to the first.
  std::span<const std::unique_ptr<DetachedMap>> all() const { return maps_; }
  /// Frees the device's memory for the first map, for good.
  void giveUp();

 private:
  /// How long a camera has been lost.
  class Loss {
   public:
    void add(TrackingStatus status, double timestamp);
    bool isLong() const;

   private:
    std::optional<double> since_;
    double now_ = 0;
    int frames_ = 0;
  };

  void begin(const Frame& frame, FrameResult& result);
  FrameResult follow(DetachedMap& map, const Frame& frame, FrameResult& result);
  /// Of a frame that was `found` in this map.
  void lookForOthers(Submap& in, DetachedMap* detached, const Frame& frame, const FrameResult& found,
                     FrameResult& result);
  /// Whether `map` belongs where the frame is `there` in `into`, and if so carries it over. `detached`:
  /// `into` where that is one; null: it is the first.
  bool join(Submap& into, DetachedMap* detached, const Pose& there, bool integrated, DetachedMap& map,
            const FrameResult& here, FrameResult& result);
  bool contradicts(Submap& into, const DetachedMap& map, const Pose& into_from_map) const;
  void remove(const DetachedMap& map);

  Work work_;
  double intruding_share_;
  std::vector<std::unique_ptr<DetachedMap>> maps_;
  DetachedMap* active_ = nullptr;  ///< the one the camera goes on in
  Loss loss_, active_loss_;
  std::size_t numbered_ = 1, asked_ = 0, keyframes_ = 0, unasked_ = 0;
  bool device_is_full_ = false;
};

}  // namespace rosefusion
