#include "apps/viewer/panels.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "apps/viewer/imgui_versions.h"

namespace rosefusion::viewer {
namespace {

constexpr int kFiguresWidth = 380, kControlsHeight = 112;
constexpr int kAllInOneRow = 620;  // pixels that the controls need for that
constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr float kFontSize = 15, kLargeSize = 22;
constexpr float kMegabyte = 1 << 20;

const ImVec4 kGood{0.45f, 0.85f, 0.45f, 1}, kCaution{1.0f, 0.75f, 0.25f, 1}, kBad{1.0f, 0.42f, 0.38f, 1},
    kCalm{0.65f, 0.70f, 0.78f, 1}, kNew{0.45f, 0.75f, 1.0f, 1};

void place(const Rectangle& r) {
  ImGui::SetNextWindowPos({float(r.x), float(r.y)});
  ImGui::SetNextWindowSize({float(r.width), float(r.height)});
}

constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                    ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                                    ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoSavedSettings;

struct Words {
  ImVec4 colour;
  std::string headline, detail;
};

Words wordsOf(const Snapshot& s) {
  switch (s.phase) {
    case Phase::Empty:
      return {kCalm, "No sequence", "Type a folder below, or drag it in."};
    case Phase::Opening:
      return {kCalm, "Opening ...", s.source};
    case Phase::Failed:
      return {kBad, "Failed", ""};
    default:
      break;
  }
  if (!s.last) return {kCalm, "Ready", "Press Play, or Step for one frame."};
  Words words;
  switch (s.last->status) {
    case TrackingStatus::Tracked:
      words = {kGood, "Tracking", "The camera is known."};
      break;
    case TrackingStatus::Uncertain:
      words = {kCaution, "Uncertain", ""};
      break;
    case TrackingStatus::Relocalised:
      words = {kNew, "Found again", ""};
      break;
    case TrackingStatus::Lost:
      words = {kBad, "Lost", ""};
      break;
  }
  if (const std::string reason = toString(s.last->reason); !reason.empty()) {
    words.detail = reason + ".";
    words.detail[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words.detail[0])));
  }
  if (s.phase == Phase::Paused) words.headline += " - paused";
  if (s.phase == Phase::Finished) words.headline += " - finished";
  return words;
}

void heading(const char* text) {
  ImGui::Spacing();
  ImGui::TextColored(kCalm, "%s", text);
  ImGui::Separator();
}

void figure(const char* label, const char* pattern, double value) {
  ImGui::TextUnformatted(label);
  ImGui::SameLine(170);
  ImGui::Text(pattern, value);
}

void drawStatus(const Snapshot& s) {
  const Words words = wordsOf(s);
  pushFont(*ImGui::GetIO().Fonts->Fonts.back());
  ImGui::TextColored(words.colour, "%s", words.headline.c_str());
  ImGui::PopFont();
  // Two lines are kept free, so that what is below stays where it is.
  const float below = ImGui::GetCursorPosY() + 2 * ImGui::GetTextLineHeightWithSpacing();
  ImGui::TextWrapped("%s", words.detail.c_str());
  ImGui::SetCursorPosY(below);
  if (s.expected > 0)
    ImGui::Text("Frame %zu of %zu", s.frames, s.expected);
  else
    ImGui::Text("Frame %zu", s.frames);
  if (s.dropped > 0) {
    ImGui::SameLine();
    ImGui::TextColored(kCaution, "(%zu dropped: too fast)", s.dropped);
  }
}

void drawSpeeds(const Snapshot& s, const PanelState& state) {
  heading("Motion");
  figure("Speed", "%.2f m/s", s.speed);
  figure("Turning", "%.2f rad/s", s.turn_rate);
  heading("Milliseconds a frame");
  const StageMilliseconds t = s.last && !state.headless ? s.last->milliseconds : StageMilliseconds{};
  std::vector<std::pair<const char*, double>> stages{
      {"Prepare", t.preprocess}, {"Track", t.track}, {"Fuse", t.integrate}};
  if (s.settings.loops.enabled) stages.emplace_back("Loops", t.loops);
  for (const auto& [name, milliseconds] : stages) {
    ImGui::TextUnformatted(name);
    ImGui::SameLine(90);
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", milliseconds);
    ImGui::ProgressBar(static_cast<float>(milliseconds / std::max(t.total, 1e-3)), {-1, 16}, text);
  }
  if (!state.headless)
    ImGui::Text("%.1f in all, %.1f frames/s; viewer %.0f ms", t.total, s.last ? s.frames_per_second : 0.0,
                state.draw_milliseconds);
}

/// The particles of one iteration along the first two axes, and the ellipsoid.
void drawParticles(const SwarmIteration& iteration) {
  const float side = 150;
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::Dummy({side, side});
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(corner, {corner.x + side, corner.y + side}, IM_COL32(14, 15, 18, 255), 3);
  const ImVec2 centre{corner.x + side / 2, corner.y + side / 2};
  double reach = std::max({iteration.shift.x(), iteration.shift.y(), 1e-9});
  float best = 1, worst = 0;
  for (const auto& p : iteration.shown) {
    reach = std::max({reach, std::abs(p.at.x()), std::abs(p.at.y())});
    best = std::min(best, p.loss);
    worst = std::max(worst, p.loss);
  }
  const double scale = 0.46 * side / reach;
  list->PushClipRect(corner, {corner.x + side, corner.y + side}, true);
  for (const auto& p : iteration.shown) {
    const float share = worst > best ? (p.loss - best) / (worst - best) : 0;
    const ImVec2 at{centre.x + static_cast<float>(p.at.x() * scale),
                    centre.y + static_cast<float>(p.at.y() * scale)};
    list->AddCircleFilled(
        at, 1.6f, ImGui::ColorConvertFloat4ToU32({0.25f + 0.75f * share, 0.95f - 0.7f * share, 0.35f, 0.9f}),
        6);
  }
  constexpr int kSegments = 40;
  for (int i = 0; i < kSegments; ++i) {
    const auto point = [&](int k) {
      const double angle = 2 * 3.14159265358979 * k / kSegments;
      return ImVec2{centre.x + static_cast<float>(std::cos(angle) * iteration.shift.x() * scale),
                    centre.y + static_cast<float>(std::sin(angle) * iteration.shift.y() * scale)};
    };
    list->AddLine(point(i), point(i + 1), IM_COL32(230, 232, 236, 200), 1);
  }
  list->PopClipRect();
}

void drawSwarm(const Snapshot& s, PanelState& state) {
  heading("Swarm");
  const auto& swarm = *s.swarm;
  if (swarm.empty()) {
    ImGui::TextDisabled("No search yet.");
    ImGui::Dummy({0, 150 + ImGui::GetTextLineHeightWithSpacing()});
    return;
  }
  const int count = static_cast<int>(swarm.size());
  std::vector<float> likelihood;
  for (const SwarmIteration& i : swarm) likelihood.push_back(static_cast<float>(i.likelihood));
  const int shown = state.iteration < 0 ? count - 1 : std::min(state.iteration, count - 1);
  const SwarmIteration& iteration = swarm[static_cast<std::size_t>(shown)];
  drawParticles(iteration);
  ImGui::SameLine();
  ImGui::BeginGroup();
  ImGui::Text("%d particles", iteration.particles);
  ImGui::Text("%.1f x %.1f x %.1f cm", 100 * iteration.shift.x(), 100 * iteration.shift.y(),
              100 * iteration.shift.z());
  ImGui::Text("turn %.3f", iteration.turn.maxCoeff());
  ImGui::TextDisabled("likelihood");
  ImGui::PlotLines("##likelihood", likelihood.data(), count, 0, nullptr, 0, 1,
                   {ImGui::GetContentRegionAvail().x, 42});
  int chosen = shown + 1;
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderInt("##iteration", &chosen, 1, count, "iteration %d"))
    state.iteration = chosen == count ? -1 : chosen - 1;
  ImGui::EndGroup();
  ImGui::TextDisabled("green: fits best, red: worst; line: the ellipsoid");
}

void drawMemory(const Snapshot& s) {
  heading("Memory");
  figure("Model", "%.1f MiB", s.model_bytes / kMegabyte);
  figure("All on the device", "%.1f MiB", s.device_bytes / kMegabyte);
}

/// One row; the session hears of what was changed.
void drawSetting(const SettingsField& field, Settings settings, Session& session) {
  const std::string id = "##" + field.key, name = field.key.substr(field.key.find('.') + 1);
  const bool live = isLiveSetting(field.key);
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(live ? kGood : ImGui::GetStyleColorVec4(ImGuiCol_Text), "%s", name.c_str());
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("%s%s%s\n%s", field.help.c_str(),
                      field.unit.empty() ? "" : "; unit: ", field.unit.c_str(),
                      live ? "Takes effect at once." : "Takes effect with the next reset.");
  ImGui::SameLine(215);
  ImGui::SetNextItemWidth(-1);
  FieldRef ref = field.ref(settings);
  if (auto* flag = std::get_if<bool*>(&ref)) {
    if (ImGui::Checkbox(id.c_str(), *flag)) session.set(field.key, **flag ? "true" : "false");
  } else if (auto* choice = std::get_if<ChoiceRef>(&ref)) {
    if (ImGui::BeginCombo(id.c_str(), fieldText(settings, field).c_str())) {
      for (const std::string& word : choice->words)
        if (ImGui::Selectable(word.c_str())) session.set(field.key, word);
      ImGui::EndCombo();
    }
  } else {
    std::string text = fieldText(settings, field);
    if (ImGui::InputText(id.c_str(), &text,
                         ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll))
      session.set(field.key, text);
  }
}

void drawSettings(const Rectangle& area, const Snapshot& s, Session& session, PanelState& state) {
  place(area);
  ImGui::Begin("settings", nullptr, kFixed & ~ImGuiWindowFlags_NoBringToFrontOnFocus);
  ImGui::TextColored(kCalm, "Settings");
  ImGui::SameLine(area.width - 90.0f);
  if (ImGui::Button("Close", {74, 0})) state.settings_open = false;
  ImGui::TextWrapped("Green ones take effect at once, the others with the next reset.");
  for (const std::string& choice : s.choices) ImGui::TextWrapped("%s", choice.c_str());
  ImGui::SetNextItemWidth(-1);
  if (state.focus_filter) ImGui::SetKeyboardFocusHere();
  state.focus_filter = false;
  ImGui::InputTextWithHint("##filter", "find", &state.settings_filter);
  if (s.settings_wait) {
    if (ImGui::Button("Reset now, to use the new settings", {-1, 0})) session.reset();
  }
  ImGui::Checkbox("for experts too", &state.expert_settings);
  std::string group;
  for (const SettingsField& field : settingsTable()) {
    if (field.key.find(state.settings_filter) == std::string::npos) continue;
    // Who names one wants to see it.
    if (state.settings_filter.empty() && !state.expert_settings && isExpertSetting(field.key)) continue;
    const std::string its_group = field.groupName();
    if (its_group != group) heading(its_group.c_str());
    group = its_group;
    drawSetting(field, s.settings, session);
  }
  ImGui::End();
}

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

void drawButtons(Session& session, PanelState& state, Requests& requests) {
  heading("Save and change");
  const float half = (ImGui::GetContentRegionAvail().x - 8) / 2;
  if (ImGui::Button("Mesh (M)", {half, 0})) session.saveMesh(state.out / "mesh.ply");
  ImGui::SameLine();
  if (ImGui::Button("Trajectory (T)", {half, 0})) session.saveTrajectory(state.out / "trajectory.txt");
  if (ImGui::Button("Screenshot (P)", {half, 0})) requests.screenshot = true;
  ImGui::SameLine();
  if (ImGui::Button("Settings (G)", {half, 0})) state.settings_open = state.focus_filter = true;
  ImGui::TextDisabled("Space play, N step, R reset, 1 2 3 views, Ctrl+Q quit");
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
  place(layout.figures);
  ImGui::Begin("figures", nullptr, kFixed);
  drawStatus(s);
  drawSpeeds(s, state);
  drawSwarm(s, state);
  drawMemory(s);
  drawButtons(session, state, requests);
  ImGui::End();
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
