// The images of keyframes, compressed losslessly in the host's memory, within a limit.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/frame.h"
#include "host/sources/image_codec.h"

namespace rosefusion {

/// Numbers keyframes in the order in which they come. Beyond the limit it drops the images of the keyframe
/// that leaves the smallest gap in the way travelled; never the first's and the last's. One thread.
class KeyframeImages {
 public:
  explicit KeyframeImages(std::uint64_t limit_bytes) : limit_bytes_(limit_bytes) {}

  /// Keeps copies of depth and colour; `travelled`: how far the camera had come, growing.
  void add(const Frame& frame, double travelled);
  std::size_t size() const { return kept_.size(); }
  /// Whether its images are still there.
  bool has(std::size_t keyframe) const { return !kept_[keyframe].depth.empty(); }
  double timestamp(std::size_t keyframe) const { return kept_[keyframe].timestamp; }
  /// The images and the timestamp; has() must be true.
  Frame frame(std::size_t keyframe);
  std::uint64_t bytes() const { return bytes_; }

 private:
  struct Kept {
    double timestamp = 0, travelled = 0;
    cv::Size size;
    std::vector<std::byte> depth, colour;
  };
  void thin();

  std::uint64_t limit_bytes_, bytes_ = 0;
  std::vector<Kept> kept_;
  ImageCodec codec_;
};

}  // namespace rosefusion
