// A recorded sequence as a source: as fast as it is taken, or at the speed it was recorded with.
#pragma once
#include <chrono>
#include <future>
#include <memory>
#include <vector>

#include "host/sources/frame_source.h"

namespace rosefusion {

struct RunOptions {
  std::size_t stride = 1;      ///< take every stride-th frame
  std::size_t max_frames = 0;  ///< after the stride; 0: all
  std::size_t start = 0;       ///< so many frames of the sequence are left out at its beginning
};

/// The indices that a run takes from a sequence of `size` frames.
std::vector<std::size_t> selectedFrames(std::size_t size, const RunOptions& options);

enum class Pace {
  AsTaken,   ///< every frame, read ahead on another thread
  Recorded,  ///< as from a live camera: a frame that was not taken before the next one came is dropped
};

class SequenceSource : public FrameSource {
 public:
  /// `sequence` must outlive this.
  SequenceSource(Sequence& sequence, const RunOptions& options, Pace pace = Pace::AsTaken);
  SequenceSource(std::unique_ptr<Sequence> sequence, const RunOptions& options, Pace pace);
  ~SequenceSource() override;

  const SequenceInfo& info() const override { return sequence_.info(); }
  std::size_t expectedFrames() const override { return indices_.size(); }
  std::vector<Finding> findings(const DepthLimits& limits) override;
  /// With Pace::Recorded the clock starts at the first call.
  SourceState next(SourceFrame& out, const StopQuestion& stop) override;

 private:
  using Clock = std::chrono::steady_clock;
  void readAhead();
  bool waitForCamera(const StopQuestion& stop);
  Clock::time_point due(std::size_t position) const;

  std::unique_ptr<Sequence> owned_;
  Sequence& sequence_;
  const std::vector<std::size_t> indices_;
  const Pace pace_;
  std::size_t position_ = 0;  ///< in indices_: the next frame
  std::size_t dropped_ = 0;
  Clock::time_point start_{};
  std::future<SourceFrame> ahead_;
};

}  // namespace rosefusion
