#include "host/export/texture/views.h"

#include <algorithm>
#include <cmath>

namespace rosefusion {
namespace {

double medianOf(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Of those of the mesh's vertices that are before the camera and in its image: hidden ones count too.
double typicalDepth(const TriangleMesh& mesh, const Intrinsics& camera, const Pose& world_from_camera) {
  const Eigen::Isometry3f camera_from_world = world_from_camera.inverse().cast<float>();
  const std::size_t step = std::max<std::size_t>(1, mesh.vertices.size() / 2000);
  std::vector<double> depths;
  for (std::size_t i = 0; i < mesh.vertices.size(); i += step) {
    const Eigen::Vector3d p = (camera_from_world * mesh.vertices[i]).cast<double>();
    if (p.z() < 0.05) continue;
    const Eigen::Vector2d pixel = camera.project(p);
    if (pixel.x() > 0 && pixel.y() > 0 && pixel.x() < camera.width && pixel.y() < camera.height)
      depths.push_back(p.z());
  }
  return depths.empty() ? 1 : medianOf(depths);
}

/// Pixels that what is seen moves between two poses, at most: turn and shift may cancel each other.
double motionBetween(const Pose& a, const Pose& b, double depth, const Intrinsics& camera) {
  return std::abs(camera.fx) * (turnBetween(a, b) + shiftBetween(a, b) / depth);
}

/// Sets the blur from the motion to the neighbours in time. Shutters are open for half of the time between
/// frames, as film cameras' are; which share it is matters little, for views are compared.
void predictBlur(std::vector<TextureView>& views, const std::vector<double>& seconds,
                 const Intrinsics& camera) {
  constexpr double kOpen = 0.5;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < seconds.size(); ++i) intervals.push_back(seconds[i] - seconds[i - 1]);
  if (intervals.empty()) return;
  const double usual = medianOf(intervals);
  for (std::size_t i = 0; i < views.size(); ++i)
    for (const std::size_t other : {i - 1, i + 1}) {
      if (other >= views.size()) continue;  // before the first, too
      const double passed = std::abs(seconds[i] - seconds[other]);
      if (passed <= 0) continue;
      const double motion =
          motionBetween(views[i].world_from_camera, views[other].world_from_camera, views[i].depth, camera);
      views[i].blur = std::max(views[i].blur, motion * usual / std::max(passed, usual) * kOpen);
    }
}

std::vector<TextureView> slowestOfStretches(const std::vector<TextureView>& views, const Intrinsics& camera,
                                            double longest) {
  std::vector<TextureView> chosen;
  const TextureView* first = nullptr;
  for (const TextureView& view : views) {
    if (!first || motionBetween(first->world_from_camera, view.world_from_camera,
                                std::min(first->depth, view.depth), camera) > longest) {
      first = &view;
      chosen.push_back(view);
    } else if (view.blur < chosen.back().blur) {
      chosen.back() = view;
    }
  }
  return chosen;
}

}  // namespace

std::vector<TextureView> chooseViews(std::span<const PageFrame> frames, const Intrinsics& camera,
                                     const TriangleMesh& mesh, std::size_t most) {
  std::vector<TextureView> tracked;
  std::vector<double> seconds;
  for (const PageFrame& frame : frames)
    if (frame.placed && frame.status == "tracked") {
      tracked.push_back(
          {frame.number, frame.world_from_camera, typicalDepth(mesh, camera, frame.world_from_camera)});
      seconds.push_back(frame.seconds);
    }
  predictBlur(tracked, seconds, camera);
  // Where the image moves by a twenty-fourth of its width, all but that is seen again; by a quarter, there
  // are still three or four images of everything.
  const double width = camera.width;
  std::vector<TextureView> chosen = slowestOfStretches(tracked, camera, width / 24);
  for (double longest = width / 20; chosen.size() > most && longest < width / 4; longest *= 1.25)
    chosen = slowestOfStretches(tracked, camera, longest);
  return chosen;
}

double usualLength(const std::vector<TextureView>& views, const Intrinsics& camera, double pixels) {
  std::vector<double> depths;
  for (const TextureView& view : views) depths.push_back(view.depth);
  return pixels * medianOf(depths) / std::abs(camera.fx);
}

}  // namespace rosefusion
