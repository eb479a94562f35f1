// A sequence whose frames lie in one file: what the readers of such files have in common.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/datasets/byte_reader.h"
#include "host/datasets/camera_source.h"
#include "host/datasets/sequence.h"

namespace rosefusion::datasets {

/// Where a frame lies, in the reader's own terms.
struct FramePlace {
  double timestamp = 0;
  std::uint64_t depth = 0, depth_bytes = 0;
  std::uint64_t colour = 0, colour_bytes = 0;
  std::uint64_t confidence = 0;
};

class FileSequence : public Sequence {
 public:
  double timestamp(std::size_t index) const override { return frames_.at(index).timestamp; }
  bool read(std::size_t index, Frame& frame, std::string& problem) override;

 protected:
  FileSequence(const std::filesystem::path& file, const char* format, const SequenceOptions& options);

  /// For the constructors. Throws InputError where there is no frame; sorts them by time.
  void setFrames(std::vector<FramePlace> frames);
  /// The first of a few frames whose depth can be read. Throws InputError.
  cv::Mat firstDepth();

  /// CV_16UC1, or CV_32FC1 in metres. Throws EndOfBytes for a damaged one, as the others do.
  virtual cv::Mat depthOf(const FramePlace& frame) = 0;
  /// CV_8UC3 (BGR) of any size that shows what depth shows; empty: there is none.
  virtual cv::Mat colourOf(const FramePlace& frame) = 0;
  /// CV_8UC1 as large as depth; what is 0 there is left out. Empty: there is none.
  virtual cv::Mat confidenceOf(const FramePlace&) { return {}; }

  std::vector<FramePlace> frames_;

 private:
  bool load_colour_;
};

inline constexpr int kMostImageSide = 16384;  ///< pixels; what says more is damaged

/// An image in a known format, such as JPEG. Throws EndOfBytes for a damaged one.
cv::Mat decodedColour(std::span<const std::byte> bytes);
/// Throws EndOfBytes where there are not just as many bytes as the image has.
cv::Mat imageOf(std::span<const std::byte> bytes, cv::Size size, int type);

/// "N of M frames are there; the file was cut or damaged, and is read up to there."
std::string cutFile(const std::filesystem::path& file, std::uint64_t there, std::uint64_t announced);

}  // namespace rosefusion::datasets
