// The sequences that experiments run on: generated ones, made when first needed, and recorded ones that are
// at hand.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/core/mesh.h"
#include "host/datasets/sequence.h"
#include "host/experiments/experiment.h"
#include "host/run/reconstruction.h"
#include "host/settings/settings.h"
#include "host/synth/options.h"

namespace rosefusion {

/// A generated sequence, in memory.
class MemorySequence : public Sequence {
 public:
  explicit MemorySequence(const SynthOptions& options);
  double timestamp(std::size_t index) const override { return frames_[index].timestamp; }
  bool read(std::size_t index, Frame& frame, std::string&) override;

  const std::vector<Frame>& frames() const { return frames_; }
  /// The part of the true surface that the camera saw; the frame of info().truth.
  const TriangleMesh& seen() const { return seen_; }

 private:
  std::vector<Frame> frames_;
  TriangleMesh seen_;
};

struct TestSequence {
  std::string name;
  std::string key;  ///< all that its frames depend on
  std::size_t frames = 0;
  RunOptions run;
  int stride_factor = 1;  ///< of the settings' pixel strides, for images larger than the generated ones
  std::function<std::shared_ptr<Sequence>()> open;
};

/// `synth` under a name. The last few opened stay in memory for the next caller.
TestSequence generated(const std::string& name, const SynthOptions& synth);

/// The experiments' camera, noise and length; the seed is still to be set.
SynthOptions experimentSynth(const ExperimentContext& context, int full_frames, int quick_frames);

/// The fast flights through furnished rooms that stand in for FastCaMo-Synth: up to 4 m/s and 2.2 rad/s.
std::vector<TestSequence> fastRooms(const ExperimentContext& context);

/// Recorded sequences with truth in options.data or one folder below, each shortened when quick.
std::vector<TestSequence> recordedSequences(const ExperimentContext& context);

/// The paper's method (preset paper), with the experiments' number of particles and seed.
Settings experimentSettings(const ExperimentContext& context);
/// `settings` with changes as --set makes them.
Settings changed(Settings settings, const std::vector<std::string>& assignments);

}  // namespace rosefusion
