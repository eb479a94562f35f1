#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "apps/viewer/imgui_versions.h"
#include "apps/viewer/panels.h"

namespace rosefusion::viewer {
namespace {

constexpr float kLine = 2.5f;
constexpr double kNear = 0.05;          // metres: what is nearer to the eye is not drawn
constexpr double kFrustumDepth = 0.35;  // metres
constexpr ImU32 kCamera = IM_COL32(255, 255, 255, 230);

/// Blue through green and yellow to red.
ImU32 speedColour(double share) {
  constexpr std::array<std::array<double, 3>, 5> kStops{
      {{0.19, 0.42, 0.95}, {0.10, 0.80, 0.85}, {0.40, 0.90, 0.30}, {1.00, 0.80, 0.15}, {0.95, 0.20, 0.15}}};
  const double at = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const auto i = std::min<std::size_t>(static_cast<std::size_t>(at), kStops.size() - 2);
  std::array<float, 3> c{};
  for (std::size_t k = 0; k < 3; ++k)
    c[k] = static_cast<float>(kStops[i][k] + (at - double(i)) * (kStops[i + 1][k] - kStops[i][k]));
  return ImGui::ColorConvertFloat4ToU32({c[0], c[1], c[2], 1});
}

/// The upper end of the colour bar: a round figure above the fastest.
double speedScale(const std::vector<PathPoint>& path) {
  double fastest = 0.1;
  for (const PathPoint& p : path) fastest = std::max(fastest, p.speed);
  const double power = std::pow(10, std::floor(std::log10(fastest)));
  for (const double step : {1.0, 2.0, 5.0, 10.0})
    if (step * power >= fastest) return step * power;
  return fastest;
}

/// Lines in the world, seen by the view camera.
class Projector {
 public:
  Projector(const Rectangle& area, const ViewCamera& view, const Intrinsics& tracked)
      : list_(ImGui::GetBackgroundDrawList()),
        area_(area),
        view_from_world_(view.pose().inverse()),
        camera_(view.intrinsics(area.width, area.height, tracked)) {}

  void line(const Eigen::Vector3d& from, const Eigen::Vector3d& to, ImU32 colour, float width) const {
    Eigen::Vector3d a = view_from_world_ * from, b = view_from_world_ * to;
    if (a.z() < kNear && b.z() < kNear) return;
    if (a.z() < kNear) a += (b - a) * (kNear - a.z()) / (b.z() - a.z());
    if (b.z() < kNear) b += (a - b) * (kNear - b.z()) / (a.z() - b.z());
    list_->AddLine(onScreen(a), onScreen(b), colour, width);
  }

 private:
  ImVec2 onScreen(const Eigen::Vector3d& p) const {
    const Eigen::Vector2d at = camera_.project(p);
    return {static_cast<float>(area_.x + at.x() + 0.5), static_cast<float>(area_.y + at.y() + 0.5)};
  }

  ImDrawList* list_;
  Rectangle area_;
  Pose view_from_world_;
  Intrinsics camera_;
};

void drawFrustum(const Projector& projector, const Pose& world_from_camera, const Intrinsics& k) {
  std::array<Eigen::Vector3d, 4> corners;
  const std::array<std::array<double, 2>, 4> pixels{
      {{0, 0}, {double(k.width), 0}, {double(k.width), double(k.height)}, {0, double(k.height)}}};
  for (std::size_t i = 0; i < 4; ++i)
    corners[i] = world_from_camera * k.unproject(pixels[i][0], pixels[i][1], kFrustumDepth);
  for (std::size_t i = 0; i < 4; ++i) {
    projector.line(world_from_camera.translation(), corners[i], kCamera, 1.5f);
    projector.line(corners[i], corners[(i + 1) % 4], kCamera, 1.5f);
  }
}

void drawColourBar(const Rectangle& area, double scale) {
  constexpr float kWidth = 220, kHeight = 12, kMargin = 16;
  ImDrawList* list = ImGui::GetBackgroundDrawList();
  const float x = static_cast<float>(area.x) + kMargin, y = static_cast<float>(area.y) + kMargin;
  list->AddRectFilled({x - 8, y - 8}, {x + kWidth + 8, y + kHeight + 30}, IM_COL32(20, 22, 26, 190), 4);
  constexpr int kSteps = 44;
  for (int i = 0; i < kSteps; ++i)
    list->AddRectFilled({x + kWidth * float(i) / kSteps, y},
                        {x + kWidth * float(i + 1) / kSteps, y + kHeight}, speedColour((i + 0.5) / kSteps));
  char text[32];
  for (int i = 0; i <= 2; ++i) {
    std::snprintf(text, sizeof text, i == 2 ? "%g m/s" : "%g", scale * i / 2);
    const float width = ImGui::CalcTextSize(text).x;
    const float left = x + (kWidth - width) * float(i) / 2;
    list->AddText({left, y + kHeight + 4}, IM_COL32(230, 232, 236, 255), text);
  }
}

/// Where one looks while holding a camera: that it is lost, and what helps.
void drawLost(const Rectangle& area) {
  constexpr float kMargin = 14;
  constexpr std::array<const char*, 2> kLines{"Lost - nothing is added to the model",
                                              "Point the camera at what it has seen before."};
  ImFont* large = ImGui::GetIO().Fonts->Fonts.back();
  const float first = sizeOf(*large), second = ImGui::GetFontSize();
  const ImVec2 size = large->CalcTextSizeA(first, 1e9f, 0, kLines[0]),
               advice = ImGui::GetFont()->CalcTextSizeA(second, 1e9f, 0, kLines[1]);
  const float width = std::max(size.x, advice.x) + 2 * kMargin, height = size.y + advice.y + 2.5f * kMargin;
  const float x = float(area.x) + (float(area.width) - width) / 2,
              y = float(area.y) + 0.14f * float(area.height);
  ImDrawList* list = ImGui::GetBackgroundDrawList();
  list->AddRectFilled({x, y}, {x + width, y + height}, IM_COL32(120, 24, 20, 225), 6);
  const float middle = x + width / 2;
  list->AddText(large, first, {middle - size.x / 2, y + kMargin}, IM_COL32_WHITE, kLines[0]);
  list->AddText(ImGui::GetFont(), second, {middle - advice.x / 2, y + size.y + 1.5f * kMargin},
                IM_COL32_WHITE, kLines[1]);
}

}  // namespace

void drawOverlay(const Layout& layout, const Snapshot& snapshot, const ViewCamera& view) {
  if (!snapshot.last) return;
  ImDrawList* list = ImGui::GetBackgroundDrawList();
  const Rectangle& a = layout.surface;
  list->PushClipRect({float(a.x), float(a.y)}, {float(a.x + a.width), float(a.y + a.height)});
  const double scale = speedScale(*snapshot.path);
  const Projector projector(a, view, snapshot.camera);
  const auto& path = *snapshot.path;
  for (std::size_t i = 1; i < path.size(); ++i)
    if (path[i].connected)
      projector.line(path[i - 1].position, path[i].position, speedColour(path[i].speed / scale), kLine);
  if (view.mode() != ViewMode::FirstPerson)
    drawFrustum(projector, snapshot.last->world_from_camera, snapshot.camera);
  drawColourBar(a, scale);
  const bool has_model = snapshot.model && snapshot.model->blockCount() > 0;
  if (snapshot.last->status == TrackingStatus::Lost && has_model) drawLost(a);
  const Rectangle& d = layout.depth;
  if (d.width > 0 && snapshot.depth_number > 0)
    list->AddRect({float(d.x), float(d.y)}, {float(d.x + d.width), float(d.y + d.height)},
                  IM_COL32(230, 232, 236, 160));
  list->PopClipRect();
}

}  // namespace rosefusion::viewer
