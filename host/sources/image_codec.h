// Lossless compression of depth and colour images for the network.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

namespace rosefusion {

/// Depth cameras measure in steps, so that an image holds a few hundred different values: each pixel becomes
/// its value's rank among those, then the difference to the pixel above; low and high bytes are kept apart,
/// and zstd does the rest. Reuses its buffers: one thread at a time. Needs a little-endian processor.
class ImageCodec {
 public:
  ImageCodec();
  ~ImageCodec();

  /// CV_16UC1, at least one pixel. The bytes are good until the next call.
  std::span<const std::byte> compressDepth(const cv::Mat& depth);
  /// CV_8UC3.
  std::span<const std::byte> compressColour(const cv::Mat& colour);
  /// False when the bytes are no image of that size; nothing is then allocated that they ask for.
  bool decompressDepth(std::span<const std::byte> bytes, cv::Size size, cv::Mat& depth);
  bool decompressColour(std::span<const std::byte> bytes, cv::Size size, cv::Mat& colour);

 private:
  struct Contexts;
  std::span<const std::byte> compress(std::size_t plain_bytes);
  bool decompress(std::span<const std::byte> bytes, std::size_t plain_bytes);

  std::unique_ptr<Contexts> contexts_;
  std::vector<std::uint16_t> table_;  ///< rank of each value, or value of each rank
  std::vector<std::uint16_t> rows_;   ///< ranks of the image
  std::vector<std::uint8_t> plain_, packed_;
};

}  // namespace rosefusion
