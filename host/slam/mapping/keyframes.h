// Integrated frames that show the scene from elsewhere than those before them: where a lost camera is
// searched for, and what was seen from there.
#pragma once
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "host/slam/mapping/surface_patches.h"

namespace rosefusion {

inline constexpr int kThumbnailStride = 4;  ///< pixels between those that are remembered

/// Every kThumbnailStride-th pixel of a depth image (as of depthInMetres()).
cv::Mat thumbnailOf(const cv::Mat& metres);

struct Keyframe {
  std::size_t frame = 0;  ///< its index in Map::trajectory
  Pose world_from_camera = Pose::Identity(), camera_from_world = Pose::Identity();
  cv::Mat thumbnail;                  ///< 77 kB of 640 x 480 pixels; empty where the image was not at hand
  std::vector<SurfacePatch> patches;  ///< some of its image's, in the camera's frame
};

/// Depth images are those of depthInMetres(), or empty where an image is on the device alone. One thread.
class Keyframes {
 public:
  explicit Keyframes(const Intrinsics& camera) : camera_(camera) {}

  /// The frame that was integrated last.
  void setLast(const cv::Mat& metres, const Pose& world_from_camera, std::size_t frame);
  /// Keeps an integrated frame where none is near it: then true.
  bool offer(const cv::Mat& metres, const Pose& world_from_camera, std::size_t frame);
  const std::vector<Keyframe>& all() const { return all_; }
  /// Without patches; its thumbnail is empty before setLast().
  const Keyframe& last() const { return last_; }
  /// Of all keyframes, in the world.
  std::vector<SurfacePatch> patches() const;
  /// Of an image, in the camera's frame.
  std::vector<SurfacePatch> patchesOf(const cv::Mat& metres) const;

  /// The map was corrected: every frame's pose now, by its index.
  void move(std::span<const Pose> corrected);
  /// A pose was inserted into the trajectory with this number.
  void renumber(std::size_t inserted);
  void clear();

 private:
  Intrinsics camera_;
  std::vector<Keyframe> all_;
  Keyframe last_;
};

}  // namespace rosefusion
