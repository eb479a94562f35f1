#include "host/datasets/file_sequence.h"

#include <algorithm>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "host/core/error.h"
#include "host/datasets/float_depth.h"

namespace rosefusion::datasets {

FileSequence::FileSequence(const std::filesystem::path& file, const char* format,
                           const SequenceOptions& options)
    : load_colour_(options.colour) {
  info_.format = format;
  info_.path = file;
}

void FileSequence::setFrames(std::vector<FramePlace> frames) {
  if (frames.empty()) throw InputError(info_.path.string() + ": holds no whole frame; copy it again.");
  frames_ = std::move(frames);
  info_.frames = frames_.size();
  const auto earlier = [](const FramePlace& a, const FramePlace& b) { return a.timestamp < b.timestamp; };
  if (std::is_sorted(frames_.begin(), frames_.end(), earlier)) return;
  std::stable_sort(frames_.begin(), frames_.end(), earlier);
  info_.warnings.push_back(info_.path.string() +
                           ": the frames' time stamps are not ascending; they were sorted.");
}

cv::Mat FileSequence::firstDepth() {
  constexpr std::size_t kAttempts = 100;
  const std::size_t attempts = std::min(frames_.size(), kAttempts);
  for (std::size_t i = 0; i < attempts; ++i) try {
      return depthOf(frames_[i]);
    } catch (const EndOfBytes&) {
    }
  throw InputError(info_.path.string() + ": none of its first " + std::to_string(attempts) +
                   " depth images can be read; copy it again.");
}

bool FileSequence::read(std::size_t index, Frame& frame, std::string& problem) {
  const FramePlace& place = frames_.at(index);
  const cv::Size size(info_.intrinsics.width, info_.intrinsics.height);
  problem.clear();
  frame = {};
  frame.timestamp = place.timestamp;
  const std::string name = info_.path.string() + ": frame " + std::to_string(index);
  try {
    frame.depth = depthOf(place);
    if (frame.depth.size() != size) throw EndOfBytes();
  } catch (const EndOfBytes&) {
    frame.depth.release();
    problem = name + "'s depth image is damaged; it is left out.";
    return false;
  }
  if (frame.depth.type() == CV_32FC1) frame.depth = unitsOf(frame.depth, 1);
  try {
    if (const cv::Mat confidence = confidenceOf(place); !confidence.empty())
      frame.depth.setTo(0, confidence == 0);
  } catch (const EndOfBytes&) {
    problem = name + "'s confidence map is damaged; all its depths are taken.";
  }
  if (!load_colour_) return true;
  try {
    frame.colour = colourOf(place);
    if (!frame.colour.empty() && frame.colour.size() != size)
      cv::resize(frame.colour, frame.colour, size, 0, 0, cv::INTER_AREA);
  } catch (const EndOfBytes&) {
    frame.colour.release();
    problem = name + "'s colour image is damaged; it has depth only.";
  }
  return true;
}

cv::Mat decodedColour(std::span<const std::byte> bytes) {
  cv::Mat image;
  const cv::Mat wrapped(1, static_cast<int>(bytes.size()), CV_8U, const_cast<std::byte*>(bytes.data()));
  try {
    if (!bytes.empty()) image = cv::imdecode(wrapped, cv::IMREAD_COLOR);
  } catch (const cv::Exception&) {
  }
  if (image.empty()) throw EndOfBytes();
  return image;
}

cv::Mat imageOf(std::span<const std::byte> bytes, cv::Size size, int type) {
  cv::Mat image(size, type);
  if (bytes.size() != image.total() * image.elemSize()) throw EndOfBytes();
  std::memcpy(image.data, bytes.data(), bytes.size());
  return image;
}

std::string cutFile(const std::filesystem::path& file, std::uint64_t there, std::uint64_t announced) {
  return file.string() + ": " + std::to_string(there) + " of " + std::to_string(announced) +
         " frames are there; the file was cut or is damaged, and is read up to there.";
}

}  // namespace rosefusion::datasets
