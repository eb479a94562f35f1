#include "host/slam/loop_closure/keyframe_images.h"

#include <stdexcept>

namespace rosefusion {

void KeyframeImages::add(const Frame& frame, double travelled) {
  Kept kept{frame.timestamp, travelled, frame.depth.size(), {}, {}};
  const auto depth = codec_.compressDepth(frame.depth);
  kept.depth.assign(depth.begin(), depth.end());
  if (frame.colour.size() == frame.depth.size() && frame.colour.type() == CV_8UC3) {
    const auto colour = codec_.compressColour(frame.colour);
    kept.colour.assign(colour.begin(), colour.end());
  }
  bytes_ += kept.depth.size() + kept.colour.size();
  kept_.push_back(std::move(kept));
  while (bytes_ > limit_bytes_) {
    const std::uint64_t before = bytes_;
    thin();
    if (bytes_ == before) break;
  }
}

void KeyframeImages::thin() {
  std::size_t victim = 0, before = 0, middle = 0;
  double smallest = 0;
  for (std::size_t i = 1; i < kept_.size(); ++i) {
    if (!has(i)) continue;
    const double gap = kept_[i].travelled - kept_[before].travelled;
    if (middle && (!victim || gap < smallest)) {
      victim = middle;
      smallest = gap;
    }
    before = middle;
    middle = i;
  }
  if (!victim) return;
  bytes_ -= kept_[victim].depth.size() + kept_[victim].colour.size();
  kept_[victim].depth = {};
  kept_[victim].colour = {};
}

Frame KeyframeImages::frame(std::size_t keyframe) {
  const Kept& kept = kept_[keyframe];
  Frame frame;
  frame.timestamp = kept.timestamp;
  bool whole = codec_.decompressDepth(kept.depth, kept.size, frame.depth);
  if (whole && !kept.colour.empty()) whole = codec_.decompressColour(kept.colour, kept.size, frame.colour);
  if (!whole) throw std::logic_error("A stored keyframe is damaged; this is a mistake in the program.");
  return frame;
}

}  // namespace rosefusion
