// A source whose first frames are looked at before they are processed.
#pragma once
#include <deque>
#include <memory>

#include "host/sources/frame_source.h"

namespace rosefusion {

class PeekedSource : public FrameSource {
 public:
  explicit PeekedSource(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}

  /// The first usable depth images: `frames` of them, where so many of the first 10 * frames are usable.
  /// next() gives all of them again.
  std::vector<cv::Mat> firstDepths(std::size_t frames, const StopQuestion& stop);

  const SequenceInfo& info() const override { return source_->info(); }
  std::size_t expectedFrames() const override { return source_->expectedFrames(); }
  std::vector<Finding> findings(const DepthLimits& limits) override { return source_->findings(limits); }
  SourceState next(SourceFrame& out, const StopQuestion& stop) override;

 private:
  std::unique_ptr<FrameSource> source_;
  std::deque<SourceFrame> kept_;
  bool ended_ = false;  ///< after what is kept
};

}  // namespace rosefusion
