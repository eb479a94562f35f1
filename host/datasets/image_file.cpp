#include "host/datasets/image_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <string_view>

#include "host/core/system.h"
#include "host/datasets/npy.h"

namespace rosefusion::datasets {
namespace {

/// A complete PNG ends with its IEND chunk. Checked here because some decoders return the part they got of a
/// truncated file, its missing rows looking like invalid depth.
bool isTruncatedPng(std::string_view bytes) {
  constexpr std::string_view kSignature = "\x89PNG";
  constexpr std::size_t kTail = 64;  // the chunk takes 12 bytes; a few stray bytes behind it do no harm
  return bytes.starts_with(kSignature) &&
         bytes.substr(bytes.size() - std::min(bytes.size(), kTail)).find("IEND") == std::string_view::npos;
}

/// What a file that is no image turns out to be, by its first bytes, and what to do; empty: nothing known.
std::string whatItIs(std::string_view bytes) {
  constexpr const char* kExport =
      "; depth is read from 16-bit PNG, TIFF or PGM images with one channel, and from TIFF and .npy of "
      "floating metres, so export it as such";
  const struct {
    std::string_view begin;
    const char *what, *remedy;
  } known[] = {
      {"PK\x03\x04", "a ZIP archive (as NumPy's .npz is)", kExport},
      {"\x89HDF\r\n", "an HDF5 file", kExport},
      {"MATLAB", "a MATLAB file", kExport},
      {"Pf\n", "a PFM image of floating-point numbers", kExport},
      {"ply\n", "a PLY mesh or point cloud", kExport},
      {"# .PCD", "a point cloud", kExport},
      {"\x1f\x8b", "a gzip archive", "; unpack it"},
      {std::string_view("\0\5\x16\7", 4), "what a Mac keeps beside a file (._NAME)",
       "; name the file itself"},
      {"version https://git-lfs", "a placeholder of Git LFS", "; fetch the image itself with 'git lfs pull'"},
      {"<!DOCTYPE", "a web page", "; download the image itself"},
      {"<html", "a web page", "; download the image itself"}};
  for (const auto& kind : known)
    if (bytes.starts_with(kind.begin)) return std::string(": is ") + kind.what + kind.remedy + ".";
  return "";
}

bool decode(const std::filesystem::path& file, int flags, cv::Mat& image, std::string& problem) {
  std::error_code unknown;
  if (std::filesystem::is_directory(file, unknown)) {
    problem = file.string() + ": is a folder, and cannot be read as an image; name the images in it.";
    return false;
  }
  std::string bytes;
  if (const int code = readBytes(file, bytes)) {
    problem = file.string() + ": " +
              (code == ENOENT ? "the file is missing."
                              : std::string("the file cannot be read (") + std::strerror(code) + ").");
    return false;
  }
  if (bytes.empty()) {
    problem = file.string() + ": the file is empty; copy or download it again.";
    return false;
  }
  if (const std::string what = whatItIs(bytes); !what.empty()) {
    problem = file.string() + what;
    return false;
  }
  if (isNpy(bytes)) {
    image = decodedNpy(bytes);
    if (image.empty())
      problem = file.string() +
                ": the NumPy array is cut short or not of one image (rows x columns of uint16, float32 or "
                "float64); save it again.";
    return !image.empty();
  }
  if (isTruncatedPng(bytes)) {
    problem = file.string() + ": the PNG is truncated; copy or download it again.";
    return false;
  }
  try {
    image = cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data()), flags);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty() && bytes.starts_with("\x76\x2f\x31\x01"))
    problem =
        file.string() +
        ": is an OpenEXR image, which OpenCV reads only where the environment variable "
        "OPENCV_IO_ENABLE_OPENEXR is 1 and its channel is named Y; set that, or export depth as TIFF or "
        ".npy.";
  else if (image.empty())
    problem = file.string() + ": the image is damaged and cannot be decoded; copy or download it again.";
  return !image.empty();
}

bool hasSize(const std::filesystem::path& file, const cv::Mat& image, cv::Size expected,
             std::string& problem) {
  if (expected.empty() || image.size() == expected) return true;
  const auto text = [](cv::Size size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height);
  };
  problem = file.string() + ": the image is " + text(image.size()) + ", but this sequence is " +
            text(expected) + ".";
  return false;
}

}  // namespace

bool readDepthImage(const std::filesystem::path& file, cv::Size expected, cv::Mat& depth,
                    std::string& problem) {
  if (!decode(file, cv::IMREAD_UNCHANGED, depth, problem)) return false;
  if (depth.type() == CV_64FC1) depth.convertTo(depth, CV_32F);
  if (depth.type() != CV_16UC1 && depth.type() != CV_32FC1) {
    problem = file.string() + ": " + std::to_string(8 * depth.elemSize1()) + "-bit image with " +
              std::to_string(depth.channels()) + (depth.channels() == 1 ? " channel" : " channels") +
              "; depth must be a 16-bit image with one channel (or of floating metres), so export it again "
              "as a 16-bit PNG.";
    return false;
  }
  return hasSize(file, depth, expected, problem);
}

bool readColourImage(const std::filesystem::path& file, cv::Size expected, cv::Mat& colour,
                     std::string& problem) {
  return decode(file, cv::IMREAD_COLOR, colour, problem) && hasSize(file, colour, expected, problem);
}

bool readConfidence(const std::filesystem::path& file, cv::Size expected, cv::Mat& confidence,
                    std::string& problem) {
  if (!decode(file, cv::IMREAD_UNCHANGED, confidence, problem)) return false;
  if (confidence.type() == CV_8UC1) return hasSize(file, confidence, expected, problem);
  problem = file.string() + ": a confidence map must be an 8-bit image with one channel.";
  return false;
}

}  // namespace rosefusion::datasets
