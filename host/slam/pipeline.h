// The reconstruction: depth frames in, poses and a growing model out.
#pragma once
#include "host/core/log.h"
#include "host/slam/loop_closure/loop_closer.h"
#include "host/slam/mapping/frame_integrator.h"
#include "host/slam/mapping/map.h"
#include "host/slam/mapping/model_start.h"
#include "host/slam/relocalisation/relocaliser.h"
#include "host/slam/tracking/pose_method.h"
#include "host/slam/tracking_state.h"

namespace rosefusion {

struct StageMilliseconds {
  double total = 0;
  double preprocess = 0;
  double track = 0;
  double integrate = 0;
  double loops = 0;
};

struct FrameResult {
  double timestamp = 0;
  /// World = the camera of the first fused frame. When lost: the last pose that was tracked or uncertain.
  Pose world_from_camera = Pose::Identity();
  TrackingStatus status = TrackingStatus::Lost;
  StatusReason reason;
  PoseScore score;             ///< the numbers behind the status
  std::optional<PoseFit> fit;  ///< and those of the descent, where there was one
  /// Share of the valid pixels in space that the last fused frame saw to be empty: something has come before
  /// the camera, or the pose is wrong.
  double intruding = 0;
  bool fused = false;
  /// The model begins anew with the frame before this one, whose pose is the identity; what it held until
  /// then fits neither. All poses told before are void.
  bool began_anew = false;
  /// Its pose in Pipeline::trajectory(); none when lost.
  std::optional<std::size_t> number;
  /// Closed at this frame: all earlier poses have changed; see Pipeline::trajectory().
  std::optional<LoopClosure> loop;
  /// Poses of frames before, which were lost when they came and which this one confirms; the last of
  /// Pipeline::trajectory() before its own.
  Trajectory recovered;
  /// The camera is held again: poses of frames before, which depth had left open, have changed; see
  /// Pipeline::trajectory().
  bool stretch_closed = false;
  int iterations = 0;
  std::uint64_t lookups = 0;
  StageMilliseconds milliseconds;
};

/// Owns the volume and what finds poses in it; the Device must outlive it. One thread at a time.
class Pipeline {
 public:
  /// Throws InputError for settings that do not go together and DeviceError when the device cannot hold them.
  /// `log` is used until the constructor returns.
  Pipeline(Device& device, const Settings& settings, const Intrinsics& intrinsics,
           double depth_units_per_metre, const Log& log = {});

  /// Tracks and fuses one frame (see host/core/frame.h); colour and motion may be empty. A lost frame is a
  /// result and is not fused. Throws DeviceError (OutOfMemory) when the model outgrows the device: what was
  /// fused before stays whole.
  FrameResult processFrame(const Frame& frame);
  /// Fuses a frame whose pose is known; tracking goes on from there. Throws as processFrame(), and InputError
  /// with loops.enabled.
  void fuseFrame(const Frame& frame, const Pose& world_from_camera);
  /// Tells that a frame of known pose was fused into volume() by a fuser of the caller's. `depth`: as
  /// Frame::depth; empty where it is on the device alone, and later images are then not compared with it.
  void accept(const Pose& world_from_camera, double timestamp, const cv::Mat& depth);
  /// After the last frame, with loops.enabled: all loops are weighed once more. Throws as processFrame().
  void finish();
  /// With loops.enabled, null without.
  const LoopCloser* loops() const { return loops_.get(); }
  /// For frames of known pose, which accept() is told of. Throws InputError with loops.enabled.
  FrameIntegrator makeFuser();

  /// For displays: told of every iteration of a search with particles, from within processFrame().
  void observe(SearchObserver observer) { observer_ = std::move(observer); }
  /// Takes over what may change between frames: the limits of tracked, uncertain and lost, and the mesh's
  /// settings (isLiveSetting()). Throws InputError for settings that do not go together.
  void changeLive(const Settings& settings);

  Device& device() { return device_; }
  Volume& volume() { return map_.volume; }
  /// Poses of the frames that were not lost, as known now, since the model was begun.
  const Trajectory& trajectory() const { return map_.trajectory; }
  const Settings& settings() const { return settings_; }
  const Intrinsics& intrinsics() const { return intrinsics_; }

 private:
  /// processFrame(), but for a model that begins anew.
  FrameResult follow(const Frame& frame);
  void preprocess(const Frame& frame, FrameResult& result);
  /// Looks for the frame's pose and at what speaks for it; costs go to `result`.
  FrameEvidence examine(const Frame& frame, FrameResult& result);
  void report(const FrameEvidence& evidence, const Decision& decision, FrameResult& result);
  void integrate(FrameResult& result);
  void fuse(const Pose& world_from_camera);
  /// Tracking, after a frame of known pose was fused.
  void goOnFrom(const Pose& world_from_camera, double timestamp);
  void closeLoops(const Frame& frame, FrameResult& result);
  /// Fit of the frame at a pose, over the overlap with the last one.
  void recordScore(const Pose& world_from_camera);
  PoseScore scoreAt(const Pose& world_from_camera);
  Thresholds thresholds() const { return thresholdsOf(settings_, method_->relocalises()); }
  /// Replaces a model that hardly a frame has confirmed by one of the frames that do not fit it.
  void weighStart(const Frame& frame, FrameResult& result);
  void clear();
  /// Where the camera is never lost, keyframes serve nobody.
  bool becomesKeyframe(const Pose& world_from_camera);
  void requireFixedPoses() const;

  Device& device_;
  Settings settings_;
  Intrinsics intrinsics_;
  double depth_units_per_metre_;
  Recorder recorder_;
  FrameIntegrator fuser_;
  SwarmSearch search_;
  PoseRefiner refiner_;
  std::unique_ptr<PoseMethod> method_;
  Relocaliser relocaliser_;
  SearchObserver observer_;
  Map map_;
  std::unique_ptr<LoopCloser> loops_;  ///< with loops.enabled
  cv::Mat metres_;                     ///< the current frame's depthInMetres()
  ModelStart start_;
  InlierStatistics inlier_statistics_;
  TrackingState state_;
};

}  // namespace rosefusion
