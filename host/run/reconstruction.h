// Runs a whole sequence through the pipeline, and remembers what happened to every frame.
#pragma once
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "host/slam/pipeline.h"
#include "host/sources/sequence_source.h"

namespace rosefusion {

/// What files say of a PoseFit.
struct FitFigures {
  double cost = 1, observed_ratio = 0, inlier_ratio = 0, observability = 0;
  double shift_deviation = 0, turn_deviation = 0;  ///< metres and radians
};

/// A frame of the sequence that was processed, or skipped because its file was unusable.
struct RunFrame {
  std::size_t index = 0;    ///< in the sequence
  std::size_t dropped = 0;  ///< frames before it that a live source could not wait with
  bool skipped = false;
  std::string problem;  ///< why it was skipped
  FrameResult result;   ///< without its fit; when skipped: only the timestamp
  std::optional<FitFigures> fit;

  /// Why it was skipped or has its status, in plain words; empty when tracked.
  std::string reason() const { return skipped ? problem : toString(result.reason); }
};

struct RunProgress {
  std::size_t done = 0;
  std::size_t total = 0;  ///< 0: not known
  const RunFrame* last = nullptr;
};

enum class RunEnd { Finished, Interrupted, DeviceFull };

struct RunSummary {
  std::deque<RunFrame> frames;  ///< which does not move them, of which hours have a hundred thousand
  RunEnd end = RunEnd::Finished;
  std::string end_reason;  ///< the device's sentence for DeviceFull
  /// A detached map that a frame connected to the first.
  struct Joined {
    std::size_t map = 0;
    std::size_t at = 0;  ///< that frame, in the sequence
  };
  std::vector<Joined> joined;
  /// In the sequence, of the frame that the model was begun anew with; FrameResult::began_anew.
  std::optional<std::size_t> began_anew_with;
  double seconds = 0;                ///< wall time of the loop, reading included
  std::optional<LoopFigures> loops;  ///< with loops.enabled

  std::size_t count(TrackingStatus status) const;
  std::size_t skipped() const;
  /// Frames that came from a live source, or at recorded speed, while the tracker was busy.
  std::size_t dropped() const;
};

/// Processes the source's frames until its end, or `max_frames` of them (0: all). `progress` is called after
/// each frame; `stop` is asked before each and while the source waits, and true ends the run early. A device
/// that is full ends it too (RunEnd::DeviceFull) with everything fused so far intact. With loops.enabled the
/// poses are at the end those that the last closure left.
RunSummary reconstruct(FrameSource& source, Pipeline& pipeline, std::size_t max_frames = 0,
                       const std::function<void(const RunProgress&)>& progress = {},
                       const StopQuestion& stop = {});

/// Poses of the frames that were not lost.
Trajectory trajectoryOf(const RunSummary& summary);

/// Frames that hang together: those of the first map (number 1), or of one that was detached.
struct MapFrames {
  std::size_t map = 1;
  std::size_t frames = 0, first = 0, last = 0;  ///< in the sequence
  std::optional<std::size_t> joined_at;         ///< the frame that connected it to the first map
};
/// All maps of which frames remain. Those that were joined are told of beside the first, which holds their
/// frames.
std::vector<MapFrames> mapsOf(const RunSummary& summary);

}  // namespace rosefusion
