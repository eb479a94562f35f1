#include "host/sources/peeked_source.h"

namespace rosefusion {

std::vector<cv::Mat> PeekedSource::firstDepths(std::size_t frames, const StopQuestion& stop) {
  std::vector<cv::Mat> depths;
  while (depths.size() < frames && kept_.size() < 10 * frames) {
    SourceFrame read;
    const SourceState state = source_->next(read, stop);
    ended_ = state == SourceState::End;
    if (state != SourceState::Frame) break;
    if (read.usable) depths.push_back(read.frame.depth);
    kept_.push_back(std::move(read));
  }
  return depths;
}

SourceState PeekedSource::next(SourceFrame& out, const StopQuestion& stop) {
  if (kept_.empty()) return ended_ ? SourceState::End : source_->next(out, stop);
  if (stop && stop()) return SourceState::Stopped;
  out = std::move(kept_.front());
  kept_.pop_front();
  return SourceState::Frame;
}

}  // namespace rosefusion
