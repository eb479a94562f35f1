// ElasticFusion's .klg (Whelan et al., RSS 2015), little endian: the number of frames, then per frame its
// time in microseconds, two sizes, depth in millimetres (zlib or raw) and colour (JPEG or raw). No camera.
#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "host/core/error.h"
#include "host/datasets/compression.h"
#include "host/datasets/file_bytes.h"
#include "host/datasets/file_sequence.h"
#include "host/datasets/listing.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kKlgHeadBytes = 16;
constexpr std::uint64_t kMostPixels = 4096 * 4096;

class KlgSequence : public FileSequence {
 public:
  KlgSequence(const fs::path& file, const SequenceOptions& options)
      : FileSequence(file, "ElasticFusion .klg", options), bytes_(file) {
    readIndex();
    size_ = findSize(options);
    firstDepth();
    chooseCamera({{640, 480, 528, 528, 320, 240}, "the ElasticFusion convention", true}, 1000, true, options,
                 size_.width, size_.height, info_);
  }

 private:
  void readIndex() {
    std::vector<FramePlace> frames;
    std::int32_t announced = 0;
    std::uint64_t at = 4;
    try {
      const auto count = bytes_.at(0, 4);
      announced = ByteReader(count).number<std::int32_t>();
      for (std::int32_t i = 0; i < announced; ++i) {
        const auto head = bytes_.at(at, kKlgHeadBytes);
        ByteReader reader(head);
        FramePlace frame{1e-6 * static_cast<double>(reader.number<std::int64_t>())};
        frame.depth_bytes = reader.number<std::uint32_t>();
        frame.colour_bytes = reader.number<std::uint32_t>();
        frame.depth = at + kKlgHeadBytes;
        frame.colour = frame.depth + frame.depth_bytes;
        at = frame.colour + frame.colour_bytes;
        if (at > bytes_.size()) throw EndOfBytes();
        info_.has_colour = info_.has_colour || frame.colour_bytes > 0;
        frames.push_back(frame);
      }
    } catch (const EndOfBytes&) {
      info_.warnings.push_back(
          cutFile(info_.path, frames.size(), static_cast<std::uint64_t>(std::max(0, announced))));
    }
    setFrames(std::move(frames));
  }

  /// The file does not say: the caller does, or a JPEG does, or it is one of the customary sizes.
  cv::Size findSize(const SequenceOptions& options) {
    const std::uint64_t pixels = countPixels();
    std::vector<cv::Size> known{{640, 480},  {320, 240},  {512, 424},  {848, 480},
                                {1280, 720}, {1280, 960}, {1920, 1080}};
    if (options.intrinsics && options.intrinsics->width > 0)
      known.insert(known.begin(), {options.intrinsics->width, options.intrinsics->height});
    for (const FramePlace& frame : frames_) try {
        if (frame.colour_bytes == 0 || frame.colour_bytes == 3 * pixels) break;
        const auto jpeg = bytes_.at(frame.colour, frame.colour_bytes);
        known.insert(known.begin(), decodedColour(jpeg).size());
        break;
      } catch (const EndOfBytes&) {
      }
    for (const cv::Size& size : known)
      if (static_cast<std::uint64_t>(size.area()) == pixels) return size;
    throw InputError(info_.path.string() + ": its depth images have " + std::to_string(pixels) +
                     " pixels, and nothing says how wide they are; convert it to a folder of PNGs.");
  }

  std::uint64_t countPixels() {
    constexpr std::size_t kAttempts = 100;
    for (std::size_t i = 0; i < std::min(frames_.size(), kAttempts); ++i) {
      const FramePlace& frame = frames_[i];
      for (const std::uint64_t pixels : {640 * 480, 320 * 240})
        if (frame.depth_bytes == 2 * pixels) return pixels;
      try {
        return unpackedZlib(bytes_.at(frame.depth, frame.depth_bytes), 2 * kMostPixels).size() / 2;
      } catch (const EndOfBytes&) {
      }
    }
    throw InputError(info_.path.string() + ": no depth image can be unpacked; copy it again.");
  }

  cv::Mat depthOf(const FramePlace& frame) override {
    const auto stored = bytes_.at(frame.depth, frame.depth_bytes);
    const std::uint64_t size = 2 * static_cast<std::uint64_t>(size_.area());
    return imageOf(stored.size() == size ? stored : unpackedZlib(stored, size), size_, CV_16UC1);
  }
  cv::Mat colourOf(const FramePlace& frame) override {
    if (frame.colour_bytes == 0) return {};
    const auto stored = bytes_.at(frame.colour, frame.colour_bytes);
    if (stored.size() != 3 * static_cast<std::uint64_t>(size_.area())) return decodedColour(stored);
    cv::Mat bgr;
    cv::cvtColor(imageOf(stored, size_, CV_8UC3), bgr, cv::COLOR_RGB2BGR);
    return bgr;
  }

  FileBytes bytes_;
  cv::Size size_;
};

}  // namespace

std::unique_ptr<Sequence> openKlg(const fs::path& file, const SequenceOptions& options) {
  return std::make_unique<KlgSequence>(file, options);
}

}  // namespace rosefusion::datasets
