#include "tools/view/window/gui_motion.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

namespace ivory {

void draw_animation(ViewSession& session, GuiState& state) {
  if (!session.animation || !ImGui::CollapsingHeader("Animation", ImGuiTreeNodeFlags_DefaultOpen)) return;
  SceneAnimation& animation = *session.animation;
  const std::vector<AnimationSpan>& all = animation.file.animations();
  const auto label = [&](std::size_t i) { return all[i].name.empty() ? fmt::format("animation {}", i) : all[i].name; };
  if (all.size() > 1 && ImGui::BeginCombo("animation", label(animation.chosen).c_str())) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      ImGui::PushID(int(i));
      if (ImGui::Selectable(label(i).c_str(), i == animation.chosen)) {
        animation.chosen = i;
        animation.time_s = all[i].begin_s;
      }
      ImGui::PopID();
    }
    ImGui::EndCombo();
  }
  auto time_s = float(animation.time_s);
  if (ImGui::SliderFloat("time, s", &time_s, float(animation.span().begin_s), float(animation.span().end_s), "%.3f") &&
      std::isfinite(time_s)) {
    animation.time_s = double(time_s);
    state.animates = false;
  }
  if (ImGui::SmallButton(state.animates ? "pause" : "play")) state.animates = !state.animates;
}

void draw_lamps(ViewSession& session, GuiRequest& request) {
  if (session.lamps.empty() || !ImGui::CollapsingHeader("Lamps")) return;
  bool changed = false;
  for (std::size_t i = 0; i < session.lamps.size(); ++i) {
    ViewLamp& lamp = session.lamps[i];
    ViewLamp now = lamp;
    ImGui::PushID(int(i));
    bool moved = ImGui::Checkbox(lamp.name.c_str(), &now.on);
    ImGui::SameLine();
    moved = ImGui::ColorEdit3("##tint", &now.tint.x,
                              ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR) ||
            moved;
    moved = ImGui::SliderFloat("brightness", &now.scale, 0, 4, "%.2f") || moved;
    moved = ImGui::DragFloat3("moved, m", &now.offset_m.x, 0.01F, 0, 0, "%.2f") || moved;
    ImGui::PopID();
    const float sum =
        now.scale + now.tint.x + now.tint.y + now.tint.z + now.offset_m.x + now.offset_m.y + now.offset_m.z;
    if (!moved || !std::isfinite(sum)) continue;
    now.scale = std::max(now.scale, 0.0F);
    for (unsigned c = 0; c < 3; ++c) now.tint[c] = std::max(now.tint[c], 0.0F);
    lamp = now;
    changed = true;
  }
  if (!changed) return;
  shine(session);
  request.redraw = true;
}

}  // namespace ivory
