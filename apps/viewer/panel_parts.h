// What the panels are made of: colours, a few lines of ImGui, and the two panels that fill the right side.
#pragma once
#include <imgui.h>

#include "apps/viewer/panels.h"

namespace rosefusion::viewer {

inline const ImVec4 kGood{0.45f, 0.85f, 0.45f, 1}, kCaution{1.0f, 0.75f, 0.25f, 1},
    kBad{1.0f, 0.42f, 0.38f, 1}, kCalm{0.65f, 0.70f, 0.78f, 1}, kNew{0.45f, 0.75f, 1.0f, 1};

inline constexpr ImGuiWindowFlags kFixed =
    ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
    ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoSavedSettings;

inline void place(const Rectangle& r) {
  ImGui::SetNextWindowPos({float(r.x), float(r.y)});
  ImGui::SetNextWindowSize({float(r.width), float(r.height)});
}

inline void heading(const char* text) {
  ImGui::Spacing();
  ImGui::TextColored(kCalm, "%s", text);
  ImGui::Separator();
}

/// Status, speeds, times, swarm and memory of the last frame, and what can be saved.
void drawFigures(const Rectangle& area, const Snapshot& snapshot, Session& session, PanelState& state,
                 Requests& requests);
/// Over the figures, where they are open.
void drawSettings(const Rectangle& area, const Snapshot& snapshot, Session& session, PanelState& state);

}  // namespace rosefusion::viewer
