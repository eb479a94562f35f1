#include "host/datasets/image_sequence.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "host/core/error.h"
#include "host/datasets/float_depth.h"
#include "host/datasets/image_file.h"

namespace rosefusion::datasets {

ImageSequence::ImageSequence(Listing listing, const SequenceOptions& options)
    : frames_(std::move(listing.frames)),
      load_colour_(options.colour),
      colour_scaled_(listing.colour_scaled),
      least_confidence_(listing.least_confidence) {
  info_.format = listing.format;
  info_.path = listing.path;
  info_.frames = frames_.size();
  info_.seconds_per_stamp = listing.seconds_per_stamp;
  info_.truth = std::move(listing.truth);
  info_.notes = std::move(listing.notes);
  info_.warnings = std::move(listing.warnings);
  dropMissingColour();
  if (frames_.empty())
    throw InputError(info_.path.string() + ": holds no depth frames; check that it was copied whole.");
  sortByTime();
  const cv::Mat typical = findTypicalImage();
  const bool floating = typical.type() == CV_32FC1;
  // A convention's units are those of its 16-bit images; floating-point depth is in metres.
  const double units = floating && listing.depth_units_assumed ? 1 : listing.depth_units_per_metre;
  chooseCamera(listing.camera, units, listing.depth_units_assumed, options, typical.cols, typical.rows,
               info_);
  if (floating) floats_per_metre_ = std::exchange(info_.depth_units_per_metre, kUnitsOfMetres);
  if (!options.intrinsics && listing.camera.distortion) {
    undistortion_.emplace(*listing.camera.distortion, info_.intrinsics);
    info_.notes.push_back("The lens' distortion is removed from the images (" + info_.intrinsics_source +
                          ").");
  }
}

void ImageSequence::dropMissingColour() {
  std::size_t listed = 0, missing = 0;
  for (FrameFiles& frame : frames_) {
    if (frame.colour.empty()) continue;
    ++listed;
    if (std::filesystem::exists(frame.colour)) continue;
    ++missing;
    frame.colour.clear();
  }
  info_.has_colour = listed > missing;
  if (missing > 0)
    info_.warnings.push_back(info_.path.string() + ": " + std::to_string(missing) + " of " +
                             std::to_string(listed) +
                             " listed colour images are missing; those frames have depth only.");
}

void ImageSequence::sortByTime() {
  const auto earlier = [](const FrameFiles& a, const FrameFiles& b) { return a.timestamp < b.timestamp; };
  if (!std::is_sorted(frames_.begin(), frames_.end(), earlier)) {
    std::stable_sort(frames_.begin(), frames_.end(), earlier);
    info_.warnings.push_back(info_.path.string() +
                             ": the frames' time stamps are not ascending; they were sorted.");
  }
}

cv::Mat ImageSequence::findTypicalImage() const {
  constexpr std::size_t kAttempts = 100;  // a start this bad is not a sequence with a few damaged frames
  cv::Mat depth;
  std::string problem, first_problem;
  std::vector<cv::Mat> found;  // two must agree: one odd image at the start does not rule out all the others
  for (std::size_t i = 0; i < std::min(frames_.size(), kAttempts); ++i) {
    if (readDepthImage(frames_[i].depth, {}, depth, problem)) {
      const bool again = std::any_of(found.begin(), found.end(), [&](const cv::Mat& other) {
        return other.size() == depth.size() && other.type() == depth.type();
      });
      if (again) return depth;
      found.push_back(std::exchange(depth, {}));
    }
    if (i == 0) first_problem = problem;
  }
  if (!found.empty()) return found.front();
  throw InputError(info_.path.string() + ": none of its first " +
                   std::to_string(std::min(frames_.size(), kAttempts)) +
                   " depth images can be read; the first: " + first_problem);
}

void ImageSequence::readColour(const FrameFiles& files, Frame& frame, std::string& problem) const {
  const cv::Size size = frame.depth.size();
  if (!readColourImage(files.colour, colour_scaled_ ? cv::Size() : size, frame.colour, problem))
    frame.colour.release();
  else if (frame.colour.size() != size)
    cv::resize(frame.colour, frame.colour, size, 0, 0, cv::INTER_AREA);
}

bool ImageSequence::read(std::size_t index, Frame& frame, std::string& problem) {
  const FrameFiles& files = frames_.at(index);
  problem.clear();
  frame = {};  // fresh buffers: the caller may still hold the previous frame's
  frame.timestamp = files.timestamp;
  const cv::Size size(info_.intrinsics.width, info_.intrinsics.height);
  if (!readDepthImage(files.depth, size, frame.depth, problem)) {
    frame.depth.release();
    return false;
  }
  if (frame.depth.type() == CV_32FC1) frame.depth = unitsOf(frame.depth, floats_per_metre_);
  if (!files.confidence.empty()) {
    cv::Mat confidence;
    if (readConfidence(files.confidence, size, confidence, problem))
      frame.depth.setTo(0, confidence < least_confidence_);
  }
  if (load_colour_ && !files.colour.empty()) readColour(files, frame, problem);
  if (undistortion_) {
    undistortion_->undistortDepth(frame.depth);
    if (!frame.colour.empty()) undistortion_->undistortColour(frame.colour);
  }
  return true;
}

}  // namespace rosefusion::datasets
