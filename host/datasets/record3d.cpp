// Record3D's .r3d (an iPhone's LiDAR or TrueDepth): a ZIP of metadata (JSON) and rgbd/N.depth (LZFSE of
// floating metres), rgbd/N.conf (LZFSE of 0, 1, 2), rgbd/N.jpg.
#include <zip.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/core/error.h"
#include "host/datasets/file_sequence.h"
#include "host/datasets/float_depth.h"
#include "host/datasets/listing.h"
#include "host/datasets/lzfse.h"
#include "host/datasets/text_table.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostEntryBytes = 64u << 20;

/// One reading thread at a time.
class ZipFile {
 public:
  /// Throws InputError where its directory, at the file's end, cannot be read.
  explicit ZipFile(const fs::path& file) : zip_(zip_open(file.c_str(), ZIP_RDONLY, nullptr), &zip_discard) {
    if (!zip_)
      throw InputError(file.string() +
                       ": is no ZIP archive, or was cut; copy it again, or save what is left with "
                       "'zip -FF CUT.r3d --out WHOLE.r3d'.");
  }
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (zip_int64_t i = 0; i < zip_get_num_entries(zip_.get(), 0); ++i) {
      const char* name = zip_get_name(zip_.get(), static_cast<zip_uint64_t>(i), 0);
      out.emplace_back(name ? name : "");
    }
    return out;
  }
  /// Throws EndOfBytes for a damaged one.
  std::vector<std::byte> read(std::uint64_t entry) const {
    zip_stat_t stat;
    if (zip_stat_index(zip_.get(), entry, 0, &stat) != 0 || !(stat.valid & ZIP_STAT_SIZE) ||
        stat.size > kMostEntryBytes)
      throw EndOfBytes();
    const std::unique_ptr<zip_file_t, decltype(&zip_fclose)> in(zip_fopen_index(zip_.get(), entry, 0),
                                                                &zip_fclose);
    std::vector<std::byte> bytes(stat.size);
    char beyond;  // libzip compares checksums at the entry's end
    if (!in || zip_fread(in.get(), bytes.data(), bytes.size()) != static_cast<zip_int64_t>(bytes.size()) ||
        zip_fread(in.get(), &beyond, 1) != 0)
      throw EndOfBytes();
    return bytes;
  }

 private:
  std::unique_ptr<zip_t, decltype(&zip_discard)> zip_;
};

constexpr std::uint64_t kNone = ~std::uint64_t{0};

class Record3dSequence : public FileSequence {
 public:
  Record3dSequence(const fs::path& file, const SequenceOptions& options)
      : FileSequence(file, "Record3D", options), zip_(file) {
    const auto metadata = readEntries();
    CameraSource camera;
    try {
      camera = cameraOf(metadata);
      stampFrames(metadata);
    } catch (const nlohmann::json::exception& error) {
      throw InputError(file.string() + ": its metadata is not Record3D's (" + error.what() + ").");
    }
    const cv::Mat first = firstDepth();
    chooseCamera(camera, kUnitsOfMetres, false, options, first.cols, first.rows, info_);
  }

 private:
  nlohmann::json readEntries() {
    std::map<int, FramePlace> frames;
    std::uint64_t metadata = kNone;
    const std::vector<std::string> names = zip_.names();
    for (std::uint64_t i = 0; i < names.size(); ++i) {
      if (names[i] == "metadata") metadata = i;
      const auto take = [&](const char* ending, std::uint64_t FramePlace::*part) {
        const auto number = digitsBetween(names[i], "rgbd/", ending);
        if (!number) return;
        auto [frame, is_new] = frames.try_emplace(std::stoi(*number));
        if (is_new) frame->second = {0, kNone, 0, kNone, 0, kNone};
        frame->second.*part = i;
      };
      take(".depth", &FramePlace::depth);
      take(".jpg", &FramePlace::colour);
      take(".conf", &FramePlace::confidence);
    }
    for (const auto& [number, frame] : frames)
      if (frame.depth != kNone) {
        numbers_.push_back(static_cast<std::size_t>(number));
        places_.push_back(frame);
        info_.has_colour = info_.has_colour || frame.colour != kNone;
      }
    try {
      if (metadata == kNone) throw EndOfBytes();
      const auto bytes = zip_.read(metadata);
      const auto* text = reinterpret_cast<const char*>(bytes.data());
      auto parsed = nlohmann::json::parse(text, text + bytes.size(), nullptr, false);
      if (!parsed.is_object()) throw EndOfBytes();
      return parsed;
    } catch (const EndOfBytes&) {
      throw InputError(info_.path.string() + ": holds no readable 'metadata'; copy it again.");
    }
  }

  CameraSource cameraOf(const nlohmann::json& metadata) {
    const auto& k = metadata.at("K");  // column by column
    CameraSource camera{{metadata.at("w"), metadata.at("h"), k.at(0), k.at(4), k.at(6), k.at(7)},
                        info_.path.string() + ", metadata",
                        false};
    camera.of_same_view = true;
    if (camera.values.width < 1 || camera.values.height < 1)
      throw InputError(info_.path.string() + ": its metadata names no image size.");
    const auto each = metadata.value("perFrameIntrinsicCoeffs", nlohmann::json::array());
    std::vector<double> parts[4];  // the stabiliser moves the lens
    for (const auto& frame : each)
      for (std::size_t i = 0; i < 4; ++i) parts[i].push_back(frame.at(i));
    if (each.empty()) return camera;
    double* values[] = {&camera.values.fx, &camera.values.fy, &camera.values.cx, &camera.values.cy};
    double most = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      std::sort(parts[i].begin(), parts[i].end());
      *values[i] = parts[i][parts[i].size() / 2];
      most = std::max(most, parts[i].back() - parts[i].front());
    }
    if (most > 0.005 * camera.values.width)
      info_.notes.push_back("the intrinsics change by up to " + std::to_string(std::lround(most)) +
                            " pixels of the colour image along the recording; their median is used");
    return camera;
  }

  void stampFrames(const nlohmann::json& metadata) {
    const double fps = metadata.value("fps", kFramesPerSecond);
    const auto stamps = metadata.value("frameTimestamps", std::vector<double>());
    const auto poses = metadata.value("poses", std::vector<std::vector<double>>());
    colour_aspect_ = metadata.at("w").get<double>() / metadata.at("h").get<double>();
    depth_size_ = {metadata.value("dw", 0), metadata.value("dh", 0)};
    if (depth_size_.width < 0 || depth_size_.height < 0 || depth_size_.width > kMostImageSide ||
        depth_size_.height > kMostImageSide)
      depth_size_ = {};
    const bool stamped = !numbers_.empty() && stamps.size() > numbers_.back();
    if (!stamped && !(fps > 0 && std::isfinite(fps)))
      throw InputError(info_.path.string() + ": its metadata names neither time stamps nor a frame rate.");
    if (!stamped) info_.notes.push_back("the frames have no time stamps; they follow each other evenly");
    const std::size_t first = numbers_.empty() ? 0 : numbers_.front();
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const std::size_t n = numbers_[i];
      places_[i].timestamp = stamped ? stamps[n] : static_cast<double>(n - first) / fps;
      if (n < poses.size()) addPose(poses[n], places_[i].timestamp);
    }
    std::stable_sort(info_.truth.begin(), info_.truth.end(),
                     [](const StampedPose& a, const StampedPose& b) { return a.timestamp < b.timestamp; });
    if (!info_.truth.empty())
      info_.notes.push_back("the truth is ARKit's own odometry, good to some centimetres");
    setFrames(std::move(places_));
  }

  /// qx qy qz qw px py pz, of a camera that looks along -z with y up.
  void addPose(const std::vector<double>& v, double timestamp) {
    if (v.size() != 7 || !std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); })) return;
    const Eigen::Quaterniond q(v[3], v[0], v[1], v[2]);
    if (q.norm() < 0.1) return;
    Pose pose = Pose::Identity();
    pose.linear() = q.normalized().toRotationMatrix() * Eigen::Vector3d(1, -1, -1).asDiagonal();
    pose.translation() = Eigen::Vector3d(v[4], v[5], v[6]);
    info_.truth.push_back({timestamp, pose});
  }

  cv::Mat depthOf(const FramePlace& frame) override {
    const auto bytes = unpackedLzfse(zip_.read(frame.depth), kMostEntryBytes);
    if (depth_size_.empty()) {  // older versions do not say; it has the colour image's shape
      const std::size_t floats = bytes.size() / sizeof(float);
      const auto pixels = static_cast<double>(floats);
      const int width = static_cast<int>(std::lround(std::sqrt(pixels * colour_aspect_)));
      depth_size_ = {width, width > 0 ? static_cast<int>(pixels) / width : 0};
      if (static_cast<std::size_t>(depth_size_.area()) * sizeof(float) != bytes.size()) {
        depth_size_ = {};  // a damaged one must not decide for the others
        throw EndOfBytes();
      }
    }
    return imageOf(bytes, depth_size_, CV_32FC1);
  }
  cv::Mat confidenceOf(const FramePlace& frame) override {
    if (frame.confidence == kNone) return {};
    return imageOf(unpackedLzfse(zip_.read(frame.confidence), kMostEntryBytes), depth_size_, CV_8UC1);
  }
  cv::Mat colourOf(const FramePlace& frame) override {
    return frame.colour == kNone ? cv::Mat() : decodedColour(zip_.read(frame.colour));
  }

  ZipFile zip_;
  std::vector<std::size_t> numbers_;
  std::vector<FramePlace> places_;
  double colour_aspect_ = 1;
  cv::Size depth_size_;
};

}  // namespace

std::unique_ptr<Sequence> openRecord3d(const fs::path& file, const SequenceOptions& options) {
  return std::make_unique<Record3dSequence>(file, options);
}

}  // namespace rosefusion::datasets
