// One HTML file that shows a reconstruction in any browser, offline.
#pragma once
#include <string>
#include <vector>

#include "host/core/camera.h"
#include "host/core/mesh.h"

namespace rosefusion {

/// A frame as the page's timeline shows it.
struct PageFrame {
  std::size_t number = 0;  ///< in the recording
  double seconds = 0;
  std::string status;   ///< tracked, uncertain, relocalised, lost or skipped
  std::string reason;   ///< why it was doubted
  bool placed = false;  ///< whether it has a pose
  Pose world_from_camera = Pose::Identity();
};

struct PageContent {
  std::string title;
  TriangleMesh mesh;  ///< may be empty
  std::vector<PageFrame> frames;
  double field_of_view = 50;  ///< of the camera, from top to bottom, degrees
  double aspect = 4.0 / 3;    ///< its images' width over height
};

inline constexpr std::size_t kMostPageBytes = 15'000'000;

/// Model, path coloured by speed and timeline, turned so that y is up: by the floor where it is clear, else
/// as the cameras were held. The mesh loses triangles until the page stays under kMostPageBytes.
std::string pageOf(PageContent content);

}  // namespace rosefusion
