#include "apps/viewer/panels.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <cmath>

#include "apps/viewer/imgui_versions.h"
#include "apps/viewer/panel_parts.h"

namespace rosefusion::viewer {
namespace {

constexpr int kFiguresWidth = 380, kControlsHeight = 112;
constexpr int kAllInOneRow = 620;  // pixels that the controls need for that
constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr float kFontSize = 15, kLargeSize = 22;

void drawControls(const Snapshot& s, Session& session, ViewCamera& view, PanelState& state) {
  const float wide = 96;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - wide - 8);
  const bool entered =
      ImGui::InputTextWithHint("##path", "folder, .seq file, tcp://*:PORT, or camera (openni2:)", &state.path,
                               ImGuiInputTextFlags_EnterReturnsTrue);
  ImGui::SameLine();
  if ((ImGui::Button("Open", {wide, 0}) || entered) && !state.path.empty()) session.open(state.path);
  const bool playing = s.phase == Phase::Playing, paused = s.phase == Phase::Paused;
  ImGui::BeginDisabled(!playing && !paused);
  if (ImGui::Button(playing ? "Pause" : "Play", {wide, 0})) playing ? session.pause() : session.play();
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::BeginDisabled(!paused);
  if (ImGui::Button("Step", {wide, 0})) session.step();
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::BeginDisabled(s.source.empty());
  if (ImGui::Button("Reset", {wide, 0})) session.reset();
  ImGui::EndDisabled();
  for (const ViewMode mode : {ViewMode::Orbit, ViewMode::Follow, ViewMode::FirstPerson}) {
    if (mode != ViewMode::Orbit)
      ImGui::SameLine();
    else if (ImGui::GetWindowWidth() >= kAllInOneRow)
      ImGui::SameLine(0, 28);
    if (ImGui::RadioButton(toString(mode), view.mode() == mode)) view.setMode(mode);
  }
  ImGui::TextColored(s.problem ? kBad : kCalm, "%s", s.message.c_str());
}

/// One key, one command, unless a text field has the keyboard.
void heedKeys(const Snapshot& s, Session& session, ViewCamera& view, PanelState& state, Requests& requests) {
  if (ImGui::GetIO().WantTextInput) return;
  if (isPressed(' ')) s.phase == Phase::Playing ? session.pause() : session.play();
  if (isPressed('N')) session.step();
  if (isPressed('R')) session.reset();
  if (isPressed('M')) session.saveMesh(state.out / "mesh.ply");
  if (isPressed('T')) session.saveTrajectory(state.out / "trajectory.txt");
  if (isPressed('P')) requests.screenshot = true;
  if (isPressed('Q') && ImGui::GetIO().KeyCtrl) requests.quit = true;
  if (isPressed('G')) {
    state.settings_open = !state.settings_open;
    state.focus_filter = state.settings_open;
  }
  if (isPressed('1')) view.setMode(ViewMode::Orbit);
  if (isPressed('2')) view.setMode(ViewMode::Follow);
  if (isPressed('3')) view.setMode(ViewMode::FirstPerson);
}

void heedMouse(const Rectangle& area, ViewCamera& view) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse || view.mode() != ViewMode::Orbit) return;
  const double height = area.height;
  if (ImGui::IsMouseDragging(ImGuiMouseButton_Left, 0))
    view.turn(3 * io.MouseDelta.x / height, 3 * io.MouseDelta.y / height);
  if (ImGui::IsMouseDragging(ImGuiMouseButton_Right, 0))
    view.pan(io.MouseDelta.x / height, io.MouseDelta.y / height);
  if (io.MouseWheel != 0) view.zoom(std::pow(1.15, io.MouseWheel));
}

}  // namespace

Layout Layout::of(int width, int height, bool has_depth) {
  Layout l;
  l.figures = {width - kFiguresWidth, 0, kFiguresWidth, height};
  const int left = width - kFiguresWidth, below = kControlsHeight + (left < kAllInOneRow ? 28 : 0);
  l.controls = {0, height - below, left, below};
  l.surface = {0, 0, left, height - below};
  const int depth_width = l.surface.width / 4;
  if (has_depth)
    l.depth = {12, l.surface.height - 12 - depth_width * 3 / 4, depth_width, depth_width * 3 / 4};
  return l;
}

Requests drawPanels(const Layout& layout, const Snapshot& s, Session& session, ViewCamera& view,
                    PanelState& state) {
  Requests requests;
  heedKeys(s, session, view, state, requests);
  heedMouse(layout.surface, view);
  drawFigures(layout.figures, s, session, state, requests);
  place(layout.controls);
  ImGui::Begin("controls", nullptr, kFixed | ImGuiWindowFlags_NoScrollbar);
  drawControls(s, session, view, state);
  ImGui::End();
  if (state.settings_open) drawSettings(layout.figures, s, session, state);
  return requests;
}

void setUpStyle() {
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  if (std::filesystem::exists(kFont)) {
    io.Fonts->AddFontFromFileTTF(kFont, kFontSize);
    io.Fonts->AddFontFromFileTTF(kFont, kLargeSize);
  } else {
    io.Fonts->AddFontDefault();
  }
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 0;
  style.FrameRounding = 3;
  style.WindowBorderSize = 0;
  style.FramePadding = {8, 4};
  style.WindowPadding = {12, 10};
  style.Colors[ImGuiCol_WindowBg] = {0.13f, 0.14f, 0.17f, 1};
  style.Colors[ImGuiCol_PlotHistogram] = {0.30f, 0.52f, 0.78f, 1};
}

}  // namespace rosefusion::viewer
