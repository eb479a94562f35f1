// Which of a recording's images a texture is made of.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "host/core/camera.h"
#include "host/core/mesh.h"
#include "host/export/page.h"

namespace rosefusion {

struct TextureView {
  std::size_t frame = 0;  ///< in the recording
  Pose world_from_camera = Pose::Identity();
  double depth = 1;  ///< to the surface, typical for this view, metres
  double blur = 0;   ///< pixels that the image is expected to move while it is exposed
};

/// Tracked frames, the one that moves least of every stretch in which the camera sees much the same;
/// stretches grow until they are no more than `most`, as long as nothing is missed between them. Empty where
/// no frame is tracked.
std::vector<TextureView> chooseViews(std::span<const PageFrame> frames, const Intrinsics& camera,
                                     const TriangleMesh& mesh, std::size_t most);

/// Metres: `pixels` where the surface is seen from as far as it usually is. Not for an empty list.
double usualLength(const std::vector<TextureView>& views, const Intrinsics& camera, double pixels);

}  // namespace rosefusion
