#include <algorithm>
#include <cctype>
#include <cmath>

#include "apps/viewer/imgui_versions.h"
#include "apps/viewer/panel_parts.h"

namespace rosefusion::viewer {
namespace {

constexpr float kMegabyte = 1 << 20;

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

}  // namespace

void drawFigures(const Rectangle& area, const Snapshot& s, Session& session, PanelState& state,
                 Requests& requests) {
  place(area);
  ImGui::Begin("figures", nullptr, kFixed);
  drawStatus(s);
  drawSpeeds(s, state);
  drawSwarm(s, state);
  drawMemory(s);
  drawButtons(session, state, requests);
  ImGui::End();
}

}  // namespace rosefusion::viewer
