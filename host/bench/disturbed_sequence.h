// A sequence in which something happens that makes a tracker lose its way.
#pragma once
#include <string>

#include "host/datasets/sequence.h"

namespace rosefusion {

enum class Disturbance {
  None,
  Cut,    ///< 30 frames are missing, as when the camera was carried off
  Black,  ///< 10 frames without any valid depth
  Hand,   ///< for 30 frames something half an arm away, moving with the camera, covers half of the image
};
/// "none", "cut", "black", "hand".
const char* toString(Disturbance disturbance);
/// Throws InputError for another word.
Disturbance disturbanceFrom(const std::string& word);

/// `whole` with the disturbance in its middle. Refers to `whole`, which must outlive it. Throws InputError
/// for a sequence of fewer than 90 frames.
class DisturbedSequence : public Sequence {
 public:
  DisturbedSequence(Sequence& whole, Disturbance disturbance);
  double timestamp(std::size_t index) const override { return whole_.timestamp(indexInWhole(index)); }
  bool read(std::size_t index, Frame& frame, std::string& problem) override;

  /// Stamp of the first frame after the disturbance from which on, for the Recovery::kMostFrames that a
  /// tracker has to come back, at least half shows what was seen before it, by the true poses; infinite where
  /// there is none. Reads many frames.
  double viewReturns() const;

 private:
  std::size_t indexInWhole(std::size_t index) const;

  Sequence& whole_;
  Disturbance disturbance_;
  std::size_t first_, count_;  // of the disturbed frames, in whole_
};

}  // namespace rosefusion
