// Camera paths for other programs.
#pragma once
#include <string>
#include <vector>

#include "host/core/camera.h"

namespace rosefusion {

struct ExportedView {
  std::string colour;  ///< the image's name, relative to the file that lists it
  std::string depth;   ///< the same; empty: none
  Pose world_from_camera = Pose::Identity();
};

/// One line a pose: the twelve numbers of [R | t], camera to world, row by row. KITTI has no stamps.
std::string kittiOf(const std::vector<Pose>& poses);

/// transforms.json of nerfstudio: cameras that look along -z with y up; depth images in millimetres.
std::string nerfstudioOf(const Intrinsics& intrinsics, const std::vector<ExportedView>& views);

/// The text files of a COLMAP model with one pinhole camera.
struct ColmapModel {
  std::string cameras, images, points;
};
ColmapModel colmapOf(const Intrinsics& intrinsics, const std::vector<ExportedView>& views);

}  // namespace rosefusion
