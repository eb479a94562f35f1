// Where depth frames come from while they are tracked: a recording, a camera, or another machine.
#pragma once
#include <functional>
#include <string>

#include "host/datasets/inspection.h"

namespace rosefusion {

/// Asked while a source waits; true makes it return at once.
using StopQuestion = std::function<bool()>;

struct SourceFrame {
  std::size_t index = 0;    ///< in the recording, or counted by the camera or the sender
  std::size_t dropped = 0;  ///< frames between the last one and this that came while nobody took them
  Frame frame;              ///< when not usable: its time stamp only
  bool usable = false;
  std::string problem;  ///< one sentence about a damaged frame, to be shown; may come with a usable one
};

enum class SourceState { Frame, End, Stopped };

/// One stream of frames in the order of time. One thread at a time.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// `frames` is 0 where their number is not known beforehand.
  virtual const SequenceInfo& info() const = 0;
  /// Frames that next() will give at most; 0: not known.
  virtual std::size_t expectedFrames() const { return info().frames; }
  /// What looks wrong with a recording, from a few of its images; before the first next(). Nothing of live
  /// sources.
  virtual std::vector<Finding> findings(const DepthLimits&) { return {}; }
  /// Waits for the next frame. `out` is set for SourceState::Frame only. Throws InputError when the source
  /// fails for good, such as a camera that was unplugged.
  virtual SourceState next(SourceFrame& out, const StopQuestion& stop) = 0;
};

}  // namespace rosefusion
