// ScanNet's .sens (version 4, little endian): cameras, then per frame its pose, stamps, colour and depth.
#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "host/core/error.h"
#include "host/datasets/compression.h"
#include "host/datasets/file_bytes.h"
#include "host/datasets/file_sequence.h"
#include "host/datasets/listing.h"
#include "host/datasets/scannet_camera.h"
#include "host/datasets/truth.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kVersion = 4;
constexpr std::uint64_t kMatrixBytes = 16 * sizeof(float);
constexpr std::uint64_t kSensHeadBytes = kMatrixBytes + 4 * sizeof(std::uint64_t);
enum ColourCode { kRawColour = 0, kPng = 1, kJpeg = 2 };
enum DepthCode { kRawDepth = 0, kZlib = 1, kOcci = 2 };

std::vector<double> matrixOf(ByteReader& reader) {
  std::vector<double> matrix(16);
  for (double& value : matrix) value = reader.number<float>();
  return matrix;
}

class SensSequence : public FileSequence {
 public:
  SensSequence(const fs::path& file, const SequenceOptions& options)
      : FileSequence(file, "ScanNet .sens", options), bytes_(file) {
    try {
      readHead();
    } catch (const EndOfBytes&) {
      throw InputError(file.string() + ": cannot be read or ends within its head; copy it again.");
    }
    readIndex();
    CameraSource camera = kScanNetCamera;
    if (const auto k = intrinsicsOf(depth_matrix_))
      camera = {{size_.width, size_.height, k->fx, k->fy, k->cx, k->cy}, file.string(), false};
    info_.has_colour = colour_bytes_ > 0;
    const auto of_colour = intrinsicsOf(colour_matrix_);
    if (info_.has_colour && of_colour && !isSameView(camera.values, *of_colour)) {
      info_.has_colour = false;
      info_.notes.push_back("colour is of another view than depth and left out");
    }
    firstDepth();
    chooseCamera(camera, units_, false, options, size_.width, size_.height, info_);
  }

 private:
  void readHead() {
    const auto name_head = bytes_.at(0, 12);
    ByteReader begin(name_head);
    if (begin.number<std::uint32_t>() != kVersion)
      throw InputError(info_.path.string() + ": is no ScanNet .sens file of version 4.");
    const auto name_bytes = begin.number<std::uint64_t>();
    if (name_bytes > bytes_.size()) throw EndOfBytes();
    constexpr std::uint64_t kRest = 4 * kMatrixBytes + 7 * 4 + sizeof(std::uint64_t);
    const auto head = bytes_.at(12 + name_bytes, kRest);
    ByteReader reader(head);
    colour_matrix_ = matrixOf(reader);
    matrixOf(reader);  // where the colour camera stands
    depth_matrix_ = matrixOf(reader);
    matrixOf(reader);
    colour_code_ = reader.number<std::int32_t>();
    depth_code_ = reader.number<std::int32_t>();
    colour_size_ = sizeOf(reader);
    size_ = sizeOf(reader);
    units_ = reader.number<float>();
    announced_ = reader.number<std::uint64_t>();
    at_ = 12 + name_bytes + kRest;
    if (size_.empty()) throw EndOfBytes();
    if (depth_code_ != kRawDepth && depth_code_ != kZlib)
      throw InputError(info_.path.string() + ": its depth is " +
                       (depth_code_ == kOcci ? "compressed by OCCI" : "of an unknown compression") +
                       ", which is not read; unpack it with ScanNet's SensReader and give the folder.");
  }

  static cv::Size sizeOf(ByteReader& reader) {
    const auto width = reader.number<std::int32_t>(), height = reader.number<std::int32_t>();
    if (width < 0 || height < 0 || width > kMostImageSide || height > kMostImageSide) throw EndOfBytes();
    return {width, height};
  }

  void readIndex() {
    std::vector<FramePlace> frames;
    std::vector<std::vector<double>> poses;
    try {
      for (std::uint64_t i = 0; i < announced_; ++i) {
        const auto head = bytes_.at(at_, kSensHeadBytes);
        ByteReader reader(head);
        poses.push_back(matrixOf(reader));
        reader.number<std::uint64_t>();  // colour's stamp
        FramePlace frame{1e-6 * static_cast<double>(reader.number<std::uint64_t>())};
        frame.colour_bytes = reader.number<std::uint64_t>();
        frame.depth_bytes = reader.number<std::uint64_t>();
        frame.colour = at_ + kSensHeadBytes;
        if (frame.colour_bytes > bytes_.size() || frame.depth_bytes > bytes_.size()) throw EndOfBytes();
        frame.depth = frame.colour + frame.colour_bytes;
        at_ = frame.depth + frame.depth_bytes;
        if (at_ > bytes_.size()) throw EndOfBytes();
        colour_bytes_ += frame.colour_bytes;
        frames.push_back(frame);
      }
    } catch (const EndOfBytes&) {
      info_.warnings.push_back(cutFile(info_.path, frames.size(), announced_));
    }
    stampByNumberIfUnstamped(frames);
    for (std::size_t i = 0; i < frames.size(); ++i)
      if (Pose pose; poseFromMatrix(poses[i], pose)) info_.truth.push_back({frames[i].timestamp, pose});
    std::stable_sort(info_.truth.begin(), info_.truth.end(),
                     [](const StampedPose& a, const StampedPose& b) { return a.timestamp < b.timestamp; });
    setFrames(std::move(frames));
  }

  /// Many of these files have no stamps, or some in another unit than microseconds.
  void stampByNumberIfUnstamped(std::vector<FramePlace>& frames) {
    if (frames.size() < 2) return;
    const double interval =
        (frames.back().timestamp - frames.front().timestamp) / static_cast<double>(frames.size() - 1);
    if (interval > 1e-3 && interval < 1) return;
    for (std::size_t i = 0; i < frames.size(); ++i)
      frames[i].timestamp = static_cast<double>(i) / kFramesPerSecond;
    info_.notes.push_back("the frames have no time stamps in microseconds; 30 frames per second assumed");
  }

  cv::Mat depthOf(const FramePlace& frame) override {
    const auto stored = bytes_.at(frame.depth, frame.depth_bytes);
    const std::uint64_t size = 2 * static_cast<std::uint64_t>(size_.area());
    return imageOf(depth_code_ == kRawDepth ? stored : unpackedZlib(stored, size), size_, CV_16UC1);
  }
  cv::Mat colourOf(const FramePlace& frame) override {
    if (!info_.has_colour || frame.colour_bytes == 0) return {};
    const auto stored = bytes_.at(frame.colour, frame.colour_bytes);
    if (colour_code_ != kRawColour) return decodedColour(stored);
    cv::Mat rgb = imageOf(stored, colour_size_, CV_8UC3), bgr;
    cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
    return bgr;
  }

  FileBytes bytes_;
  std::vector<double> colour_matrix_, depth_matrix_;
  std::int32_t colour_code_ = 0, depth_code_ = 0;
  cv::Size colour_size_, size_;
  double units_ = 1000;
  std::uint64_t announced_ = 0, at_ = 0, colour_bytes_ = 0;
};

}  // namespace

std::unique_ptr<Sequence> openSens(const fs::path& file, const SequenceOptions& options) {
  return std::make_unique<SensSequence>(file, options);
}

}  // namespace rosefusion::datasets
