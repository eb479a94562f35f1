// A whole generated sequence: planned, then rendered frame by frame.
#pragma once
#include <memory>
#include <vector>

#include "host/core/frame.h"
#include "host/synth/motion.h"
#include "host/synth/options.h"
#include "host/synth/tracer.h"

namespace rosefusion {

inline constexpr double kSynthDepthUnitsPerMetre = 5000;

/// The scene and the true motion, before anything is rendered. Frames can be rendered by any number of
/// threads.
class SynthPlan {
 public:
  /// Throws InputError for options or meshes that give no sequence.
  explicit SynthPlan(const SynthOptions& options);

  const SynthOptions& options() const { return options_; }
  const Scene& scene() const { return *scene_; }
  const Tracer& tracer() const { return *tracer_; }
  const Trajectory& truth() const { return truth_; }
  MotionStatistics statistics() const { return motionStatistics(truth_, *tracer_); }

  /// Frame i as the camera reads it: 16-bit depth at kSynthDepthUnitsPerMetre, with noise and colour as asked
  /// for. `seen` as in renderDepth.
  Frame renderFrame(std::size_t i, std::vector<std::uint8_t>* seen = nullptr) const;

  /// The camera so many seconds after frame i's moment, at the speed between frames.
  Pose poseAt(std::size_t i, double seconds) const;

 private:
  cv::Mat measuredDepth(std::size_t i, Rng& rng, std::vector<std::uint8_t>* seen) const;

  SynthOptions options_;
  std::unique_ptr<Scene> scene_;  // pinned: the tracer points at it
  std::unique_ptr<Tracer> tracer_;
  Trajectory truth_;
};

/// In memory, for tests and benchmarks.
struct SynthSequence {
  Intrinsics intrinsics;
  double depth_units_per_metre = kSynthDepthUnitsPerMetre;
  std::vector<Frame> frames;
  Trajectory truth;   ///< one pose per frame, same timestamps
  TriangleMesh mesh;  ///< the true surface, same frame as truth
  MotionStatistics statistics;
};

SynthSequence makeSequence(const SynthOptions& options);

/// The triangles of `mesh` whose entry in `seen` is set, with the vertices they need.
TriangleMesh seenPart(const TriangleMesh& mesh, const std::vector<std::uint8_t>& seen);

}  // namespace rosefusion
