// The reconstruction: depth frames in, poses and a growing model out.
#pragma once
#include "host/core/log.h"
#include "host/slam/detached_maps.h"
#include "host/slam/mapping/frame_integrator.h"
#include "host/slam/relocalisation/relocaliser.h"
#include "host/slam/tracking/pose_method.h"

namespace rosefusion {

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
  Volume& volume() { return first_.map.volume; }
  /// Poses of the frames that were not lost, as known now, since the model was begun.
  const Trajectory& trajectory() const { return first_.map.trajectory; }
  /// Maps of stretches in which the camera was lost, as long as no frame connects them to volume(). None with
  /// loops.enabled.
  std::span<const std::unique_ptr<DetachedMap>> detachedMaps() const { return detached_.all(); }
  /// Seconds from the exposure of an image's first row to that of the last, as is set or was measured
  /// (depth.readout); 0 where the rows belong together, as far as is known.
  double readoutSeconds() const;
  const Settings& settings() const { return settings_; }
  const Intrinsics& intrinsics() const { return intrinsics_; }

 private:
  /// A frame's way through one map, step by step; processFrame() but for a model that begins anew.
  FrameResult follow(Submap& at, const Frame& frame);
  /// The frame without rolling shutter, and the readout that it was freed of: 0 where the camera's motion is
  /// not known.
  struct AtOnce {
    Frame frame;
    double readout;
  };
  AtOnce atOnce(const Submap& at, const Frame& frame, FrameResult& result) const;
  void preprocess(const Submap& at, const Frame& frame, FrameResult& result);
  /// Looks for the frame's pose and at what speaks for it; costs go to `result`.
  FrameEvidence examine(Submap& at, const Frame& frame, FrameResult& result);
  /// Fit of the frame at a pose, over the overlap with the last one.
  void recordScore(const Submap& at, const Pose& world_from_camera);
  PoseScore scoreAt(const Submap& at, const Pose& world_from_camera);
  void report(const Submap& at, const FrameEvidence& evidence, const Decision& decision, FrameResult& result);
  void integrate(Submap& at, FrameResult& result);
  /// Of a frame whose pose is in the trajectory or comes next there.
  void fuse(Submap& at, const Pose& world_from_camera, std::size_t number);
  /// Where the camera is never lost, keyframes serve nobody.
  bool becomesKeyframe(Submap& at, const Pose& world_from_camera, std::size_t number);
  void addPose(Submap& at, const Frame& frame, const Trajectory& recovered, FrameResult& result);
  Thresholds thresholds() const { return thresholdsOf(settings_, method_->relocalises()); }

  /// followAndWeigh() in the first map, to which detached maps give way where the device is full.
  FrameResult followInFirst(const Frame& frame);
  /// Of a frame that is not looked for in the first map, where the camera is lost.
  FrameResult unasked(const Frame& frame);
  FrameResult followAndWeigh(Submap& at, const Frame& frame);
  /// Replaces a model that hardly a frame has confirmed by one of the frames that do not fit it.
  void weighStart(Submap& at, const Frame& frame, FrameResult& result);
  void clear(Submap& at);
  DetachedMaps::Work detachedWork();

  /// Puts a frame on the device, and its metres beside it.
  void load(const Frame& frame);
  /// Tracking, after a frame of known pose was fused.
  void goOnFrom(const Pose& world_from_camera, double timestamp);
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
  Submap first_;
  std::unique_ptr<LoopCloser> loops_;  ///< with loops.enabled
  ReadoutEstimate readout_;
  cv::Mat metres_;  ///< the current frame's depthInMetres()
  DetachedMaps detached_;
};

}  // namespace rosefusion
