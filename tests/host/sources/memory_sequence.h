// A sequence that lies in memory.
#pragma once
#include <utility>
#include <vector>

#include "host/datasets/sequence.h"

namespace rosefusion::testing {

class MemorySequence : public Sequence {
 public:
  MemorySequence(std::vector<Frame> frames, const Intrinsics& intrinsics, double depth_units_per_metre = 5000)
      : frames_(std::move(frames)) {
    info_.format = "memory";
    info_.path = "memory";
    info_.intrinsics = intrinsics;
    info_.depth_units_per_metre = depth_units_per_metre;
    info_.frames = frames_.size();
  }
  double timestamp(std::size_t index) const override { return frames_.at(index).timestamp; }
  bool read(std::size_t index, Frame& frame, std::string& problem) override {
    problem.clear();
    frame = frames_.at(index);
    return true;
  }

 private:
  std::vector<Frame> frames_;
};

inline constexpr Intrinsics kSmallCamera{64, 48, 60, 60, 31.5, 23.5};

/// `count` small frames at `fps`, whose pixels tell which frame it is.
inline std::vector<Frame> numberedFrames(int count, double fps) {
  std::vector<Frame> frames;
  for (int i = 0; i < count; ++i) {
    cv::Mat depth(kSmallCamera.height, kSmallCamera.width, CV_16UC1);
    for (int row = 0; row < depth.rows; ++row)
      for (int column = 0; column < depth.cols; ++column)
        depth.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(1000 * i + 7 * row + column);
    frames.push_back({1e9 + i / fps, depth, {}});
  }
  return frames;
}

inline bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

}  // namespace rosefusion::testing
