#include "host/export/pose_formats.h"

#include <nlohmann/json.hpp>

#include "host/core/number_text.h"

namespace rosefusion {
namespace {

/// Both programs have pixel centres at halves.
constexpr double kPixelCentre = 0.5;

}  // namespace

std::string kittiOf(const std::vector<Pose>& poses) {
  std::string out;
  for (const Pose& pose : poses) {
    for (int i = 0; i < 12; ++i) out += printed(i ? " %.9g" : "%.9g", pose.matrix()(i / 4, i % 4));
    out += '\n';
  }
  return out;
}

std::string nerfstudioOf(const Intrinsics& k, const std::vector<ExportedView>& views) {
  nlohmann::ordered_json root = {
      {"camera_model", "OPENCV"},  {"fl_x", k.fx}, {"fl_y", k.fy}, {"cx", k.cx + kPixelCentre},
      {"cy", k.cy + kPixelCentre}, {"w", k.width}, {"h", k.height}};
  root["frames"] = nlohmann::ordered_json::array();
  for (const ExportedView& view : views) {
    Eigen::Matrix4d matrix = view.world_from_camera.matrix();
    matrix.middleCols<2>(1) *= -1;
    auto rows = nlohmann::ordered_json::array();
    for (int i = 0; i < 4; ++i) rows.push_back({matrix(i, 0), matrix(i, 1), matrix(i, 2), matrix(i, 3)});
    nlohmann::ordered_json frame = {{"file_path", view.colour}};
    if (!view.depth.empty()) frame["depth_file_path"] = view.depth;
    frame["transform_matrix"] = rows;
    root["frames"].push_back(frame);
  }
  return root.dump(1) + "\n";
}

ColmapModel colmapOf(const Intrinsics& k, const std::vector<ExportedView>& views) {
  ColmapModel model;
  model.cameras = printed("# CAMERA_ID MODEL WIDTH HEIGHT PARAMS\n1 PINHOLE %d %d %.9g %.9g %.9g %.9g\n",
                          k.width, k.height, k.fx, k.fy, k.cx + kPixelCentre, k.cy + kPixelCentre);
  model.images =
      "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, world to camera; the line behind it: no points\n";
  int id = 0;
  for (const ExportedView& view : views) {
    const Pose camera_from_world = view.world_from_camera.inverse();
    const Eigen::Quaterniond q = canonical(Eigen::Quaterniond(camera_from_world.linear()));
    const Eigen::Vector3d t = camera_from_world.translation();
    model.images += printed("%d %.9g %.9g %.9g %.9g %.9g %.9g %.9g 1 %s\n\n", ++id, q.w(), q.x(), q.y(),
                            q.z(), t.x(), t.y(), t.z(), view.colour.c_str());
  }
  model.points = "# POINT3D_ID X Y Z R G B ERROR TRACK[]\n";
  return model;
}

}  // namespace rosefusion
