// Whether what the model began with is worth building on: a first image may be incomplete, dark or of a hand.
#pragma once
#include <optional>

#include "host/core/frame.h"

namespace rosefusion {

/// Weighs the model's first frame against a later one that fits nowhere, until frames that agree with the
/// model have told as much as a frame can. Evidence is counted in images: the share of the pixels with a
/// depth, or with one that meets the model.
class ModelStart {
 public:
  struct Candidate {
    Frame frame;  ///< with images of its own
    double told = 0;
  };

  /// The model's first frame, of which so much has depth.
  void begin(const Frame& frame, double told);
  /// Frames like this one met the model in so much of the image, or the model must not be given up.
  void confirm(double met);
  void settle() { confirm(1); }
  /// A frame of which so much has depth and that fits nowhere. What the model may begin anew with before this
  /// frame is tried again: the one before, if that was lost as well and each of both tells more than what
  /// confirmed the model.
  std::optional<Candidate> rival(const Frame& frame, double told);
  /// None before begin() and once the model is there to stay.
  const std::optional<Candidate>& first() const { return first_; }

 private:
  bool isSettled() const { return confirmed_ >= 1; }

  std::optional<Candidate> first_, lost_;
  double confirmed_ = 0;
};

}  // namespace rosefusion
