// A sequence whose frames are image files, whatever folder layout listed them.
#pragma once
#include "host/datasets/listing.h"

namespace rosefusion::datasets {

class ImageSequence : public Sequence {
 public:
  /// Sorts the frames by time, takes the image size from the first readable depth image and chooses the
  /// intrinsics. Throws InputError when there is no frame, none of them can be read, or the intrinsics are
  /// implausible.
  ImageSequence(Listing listing, const SequenceOptions& options);

  double timestamp(std::size_t index) const override { return frames_.at(index).timestamp; }
  bool read(std::size_t index, Frame& frame, std::string& problem) override;

 private:
  void dropMissingColour();
  void sortByTime();
  /// A depth image of the size that most have.
  cv::Mat findTypicalImage() const;
  void readColour(const FrameFiles& files, Frame& frame, std::string& problem) const;

  std::vector<FrameFiles> frames_;
  bool load_colour_ = false;
  bool colour_scaled_ = false;
  int least_confidence_ = 1;
  double floats_per_metre_ = 1;  ///< of images of floating-point numbers
  std::optional<Undistortion> undistortion_;
};

}  // namespace rosefusion::datasets
