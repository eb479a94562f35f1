#include <imgui_stdlib.h>

#include "apps/viewer/panel_parts.h"

namespace rosefusion::viewer {
namespace {

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

}  // namespace

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

}  // namespace rosefusion::viewer
