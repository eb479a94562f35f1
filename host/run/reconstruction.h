// Runs a whole sequence through the pipeline, and remembers what happened to every frame.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "host/datasets/sequence.h"
#include "host/pipeline.h"

namespace rosefusion {

struct RunOptions {
  std::size_t stride = 1;      ///< take every stride-th frame
  std::size_t max_frames = 0;  ///< after the stride; 0: all
};

/// A frame of the sequence that was processed, or skipped because its file was unusable.
struct RunFrame {
  std::size_t index = 0;  ///< in the sequence
  bool skipped = false;
  FrameResult result;  ///< when skipped: only the timestamp and the reason
};

struct RunProgress {
  std::size_t done = 0;
  std::size_t total = 0;
  const RunFrame* last = nullptr;
};

enum class RunEnd { Finished, Interrupted, DeviceFull };

struct RunSummary {
  std::vector<RunFrame> frames;
  RunEnd end = RunEnd::Finished;
  std::string end_reason;  ///< the device's sentence for DeviceFull
  double seconds = 0;      ///< wall time of the loop, reading included

  std::size_t count(TrackingStatus status) const;
  std::size_t skipped() const;
};

/// The indices that a run takes from a sequence of `size` frames.
std::vector<std::size_t> selectedFrames(std::size_t size, const RunOptions& options);

/// Processes the selected frames in order, reading one ahead on another thread. `progress` is called after
/// each frame; `stop` is asked before each, and true ends the run early. A device that is full ends it too
/// (RunEnd::DeviceFull) with everything fused so far intact.
RunSummary reconstruct(Sequence& sequence, Pipeline& pipeline, const RunOptions& options,
                       const std::function<void(const RunProgress&)>& progress = {},
                       const std::function<bool()>& stop = {});

/// Poses of the frames that were not lost.
Trajectory trajectoryOf(const RunSummary& summary);

}  // namespace rosefusion
