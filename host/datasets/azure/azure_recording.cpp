// Recordings of an Azure Kinect (k4arecorder's .mkv, and what Orbbec's cameras write in its place): Matroska
// with a track DEPTH of big-endian millimetres and the cameras' calibration attached.
#include <algorithm>
#include <charconv>

#include "host/core/error.h"
#include "host/datasets/azure/azure_calibration.h"
#include "host/datasets/azure/matroska.h"
#include "host/datasets/file_bytes.h"
#include "host/datasets/file_sequence.h"
#include "host/datasets/listing.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

constexpr double kMillimetres = 1000;

template <typename Number>
std::optional<Number> wholeNumber(const std::string& text) {
  Number value;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  return end.ec == std::errc() && end.ptr == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// Of a track with codec V_MS/VFW/FOURCC: Windows' BITMAPINFOHEADER.
struct ImageKind {
  cv::Size size;
  std::string fourcc;
};

std::optional<ImageKind> imageKindOf(const MatroskaTrack& track) try {
  if (track.codec != "V_MS/VFW/FOURCC") return {};
  ByteReader header(track.codec_private);
  header.take(4);  // its own size
  ImageKind kind;
  kind.size.width = header.number<std::int32_t>();
  kind.size.height = header.number<std::int32_t>();
  header.take(4);  // planes, bits
  const auto fourcc = header.take(4);
  kind.fourcc.assign(reinterpret_cast<const char*>(fourcc.data()), fourcc.size());
  const auto plausible = [](int side) { return side > 0 && side <= kMostImageSide; };
  if (!plausible(kind.size.width) || !plausible(kind.size.height)) return {};
  return kind;
} catch (const EndOfBytes&) {
  return {};
}

/// By the tag that names a track's UID, else by the track's name.
const MatroskaTrack* findTrack(const MatroskaFile& matroska, const std::string& name) {
  const auto tag = matroska.tags.find("K4A_" + name + "_TRACK");
  const auto uid = tag == matroska.tags.end() ? std::nullopt : wholeNumber<std::uint64_t>(tag->second);
  const MatroskaTrack* named = nullptr;
  for (const MatroskaTrack& track : matroska.tracks) {
    if (uid && track.uid == *uid) return &track;
    if (!named && track.name == name) named = &track;
  }
  return named;
}

class AzureSequence : public FileSequence {
 public:
  AzureSequence(const fs::path& file, const SequenceOptions& options)
      : FileSequence(file, "Azure Kinect .mkv", options), bytes_(file) {
    const MatroskaFile matroska = readMatroska(file);
    const MatroskaTrack& depth = depthTrack(matroska);
    listFrames(matroska, depth);
    CameraSource camera;
    if (!options.intrinsics) camera = depthCamera(matroska);
    firstDepth();
    chooseCamera(camera, kMillimetres, false, options, size_.width, size_.height, info_);
    if (camera.distortion) {
      undistortion_.emplace(*camera.distortion, info_.intrinsics);
      info_.notes.push_back("The lens' distortion is removed from the images (" + info_.intrinsics_source +
                            ").");
    }
    if (findTrack(matroska, "COLOR"))
      info_.notes.push_back("colour is of another view than depth and left out");
    info_.sensor = "azure";
  }

 private:
  const MatroskaTrack& depthTrack(const MatroskaFile& matroska) {
    const MatroskaTrack* track = findTrack(matroska, "DEPTH");
    if (!track)
      throw InputError(info_.path.string() +
                       ": has no track DEPTH, as k4arecorder writes it; give a recording made with depth.");
    const auto kind = imageKindOf(*track);
    if (!kind || kind->fourcc != "b16g" || track->encoded)
      throw InputError(
          info_.path.string() +
          ": its track DEPTH is not of plain 16-bit images (b16g), as k4arecorder writes it; give "
          "the recorder's own file.");
    size_ = kind->size;
    return *track;
  }

  void listFrames(const MatroskaFile& matroska, const MatroskaTrack& depth) {
    const auto tag = matroska.tags.find("K4A_START_OFFSET_NS");
    const std::int64_t start =
        tag == matroska.tags.end() ? 0 : wholeNumber<std::int64_t>(tag->second).value_or(0);
    std::vector<FramePlace> frames;
    for (const MatroskaBlock& block : matroska.blocks) {
      if (block.track != depth.number) continue;
      const double seconds = 1e-9 * (static_cast<double>(start) + static_cast<double>(block.nanoseconds));
      frames.push_back({seconds, block.place, block.bytes});
    }
    if (matroska.cut)
      info_.warnings.push_back(info_.path.string() + ": the file was cut or is damaged; " +
                               std::to_string(frames.size()) + " depth images are there.");
    setFrames(std::move(frames));
  }

  CameraSource depthCamera(const MatroskaFile& matroska) {
    const auto tag = matroska.tags.find("K4A_CALIBRATION_FILE");
    const std::string name = tag == matroska.tags.end() ? "calibration.json" : tag->second;
    const auto file = matroska.attachments.find(name);
    if (file == matroska.attachments.end())
      throw InputError(info_.path.string() + ": holds no calibration (an attached " + name +
                       "); give --intrinsics FX,FY,CX,CY.");
    const std::string source = info_.path.string() + ", " + name;
    const LensCamera camera = azureDepthCamera(file->second, size_, source);
    return {camera.values, source, false, camera.lens};
  }

  cv::Mat depthOf(const FramePlace& frame) override {
    if (frame.depth_bytes != 2 * static_cast<std::uint64_t>(size_.area())) throw EndOfBytes();
    const auto stored = bytes_.at(frame.depth, frame.depth_bytes);
    const cv::Mat bytes = datasets::imageOf(stored, size_, CV_8UC2);
    cv::Mat depth(size_, CV_16UC1);
    for (int v = 0; v < depth.rows; ++v)
      for (int u = 0; u < depth.cols; ++u) {
        const auto& pair = bytes.at<cv::Vec2b>(v, u);
        depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(pair[0] << 8 | pair[1]);
      }
    if (undistortion_) undistortion_->undistortDepth(depth);
    return depth;
  }
  cv::Mat colourOf(const FramePlace&) override { return {}; }

  FileBytes bytes_;
  cv::Size size_;
  std::optional<Undistortion> undistortion_;
};

}  // namespace

std::unique_ptr<Sequence> openAzureRecording(const fs::path& file, const SequenceOptions& options) {
  return std::make_unique<AzureSequence>(file, options);
}

}  // namespace rosefusion::datasets
