#include "tools/view/window/gui.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "grid/base/error.h"
#include "tools/cli/common.h"
#include "tools/view/session/groups.h"
#include "tools/view/session/light.h"
#include "tools/view/window/gui_motion.h"

namespace ivory {

namespace {

void tooltip(const std::string& text) {
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text.c_str());
}

// A combo box over named values; true where another was chosen. `lack` says why one cannot be.
template <typename Value, typename Values, typename Lack>
bool choose(const char* label, Value& value, const Values& all, const Lack& lack) {
  bool changed = false;
  if (!ImGui::BeginCombo(label, std::string(name_of(value)).c_str())) return false;
  for (const Value candidate : all) {
    const std::string why_not = lack(candidate);
    const ImGuiSelectableFlags flags = why_not.empty() ? 0 : ImGuiSelectableFlags_Disabled;
    if (ImGui::Selectable(std::string(name_of(candidate)).c_str(), candidate == value, flags) && candidate != value) {
      value = candidate;
      changed = true;
    }
    if (!why_not.empty()) {
      ImGui::SameLine();
      ImGui::TextDisabled("(%s)", why_not.c_str());
    }
  }
  ImGui::EndCombo();
  return changed;
}

bool draw_assets_of(const ViewSession& session, ObjectLight& light) {
  if (light.asset == nullptr) return false;
  int others = 0;
  for (const auto& asset : session.assets) others += asset->kind() == light.asset->kind() ? 1 : 0;
  if (others < 2) {
    ImGui::TextDisabled("%s", light.asset->label().c_str());
    return false;
  }
  bool changed = false;
  if (ImGui::BeginCombo("asset", light.asset->label().c_str())) {
    for (const auto& asset : session.assets) {
      if (asset->kind() != light.asset->kind()) continue;
      if (ImGui::Selectable(asset->label().c_str(), asset.get() == light.asset) && asset.get() != light.asset) {
        light.asset = asset.get();
        changed = true;
      }
    }
    ImGui::EndCombo();
  }
  return changed;
}

// The sources that add up; true where one was changed.
bool draw_lights_of(ViewSession& session, std::size_t object) {
  std::vector<ObjectLight>& lights = session.world.objects[object].lights;
  bool changed = false;
  std::size_t removed = lights.size();
  for (std::size_t k = 0; k < lights.size(); ++k) {
    ImGui::PushID(int(k));
    ViewMethod method = lights[k].method;
    if (choose("method", method, all_view_methods, [&](ViewMethod m) { return lacks(session, m); })) {
      choose_method(session, object, k, method);
      changed = true;
    }
    changed = draw_assets_of(session, lights[k]) || changed;
    if (lights.size() > 1) {
      changed = ImGui::SliderFloat("weight", &lights[k].weight, 0, 2, "%.2f") || changed;
      if (ImGui::SmallButton("take out")) removed = k;
    }
    ImGui::PopID();
  }
  if (removed < lights.size()) {
    lights.erase(lights.begin() + std::ptrdiff_t(removed));
    changed = true;
  }
  if (ImGui::SmallButton("add a source")) lights.push_back({});
  return changed;
}

void draw_objects(ViewSession& session, GuiState& state, GuiRequest& request) {
  if (!ImGui::CollapsingHeader("Objects and their light", ImGuiTreeNodeFlags_DefaultOpen)) return;
  for (std::size_t i = 0; i < session.world.objects.size(); ++i) {
    ViewObject& object = session.world.objects[i];
    ImGui::PushID(int(i));
    if (ImGui::Selectable(object.name.c_str(), state.selected == i)) state.selected = i;
    ImGui::Indent();
    request.redraw = draw_lights_of(session, i) || request.redraw;
    if (object.moves) {
      const V3d& anchor_m = session.world.scene().anchor_m;
      V3d offset = offset_in_world(object, object.offset_m, anchor_m);
      if (ImGui::DragScalarN("place, m", ImGuiDataType_Double, &offset.x, 3, 0.01F, nullptr, nullptr, "%.3f")) {
        object.offset_m = offset_in_scene(object, offset, anchor_m);
        request.redraw = true;
      }
      V3f turn_deg = object.turn_deg;
      // Whoever types may type "nan".
      if (ImGui::DragFloat3("turn, degrees", &turn_deg.x, 0.5F, -36000, 36000, "%.1f") &&
          std::isfinite(turn_deg.x + turn_deg.y + turn_deg.z)) {
        object.turn_deg = turn_deg;
        request.redraw = true;
      }
      tooltip("about +X, then +Z, then +Y; Ctrl and the left button turn about +Y, and so do , and .");
      float scale = object.scale;
      if (ImGui::DragFloat("scale", &scale, 0.005F, 1e-3F, 1e3F, "%.3f") && scale > 0 && scale <= 1e6F) {
        object.scale = scale;
        request.redraw = true;
      }
      if (ImGui::SmallButton("remove")) request.removed = int(i);
    }
    ImGui::Unindent();
    ImGui::PopID();
  }
  if (ImGui::Checkbox("objects move on their paths (Space)", &state.playing)) request.redraw = true;
}

// A brightness and a colour for each group of lights that a grid keeps apart.
void draw_groups(ViewSession& session, GuiState& state, GuiRequest& request) {
  const std::vector<std::string> names = group_names(session);
  if (names.empty() || !ImGui::CollapsingHeader("Groups of lights", ImGuiTreeNodeFlags_DefaultOpen)) return;
  bool changed = false;
  for (const std::string& name : names) {
    const auto known = session.factors.find(name);
    GroupChoice& choice =
        state.groups.try_emplace(name, GroupChoice{1, known == session.factors.end() ? Rgb(1, 1, 1) : known->second})
            .first->second;
    ImGui::PushID(name.c_str());
    const bool scaled = ImGui::SliderFloat(name.c_str(), &choice.scale, 0, 4, "%.2f");
    ImGui::SameLine();
    const bool tinted = ImGui::ColorEdit3(
        "##tint", &choice.tint.x, ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR);
    ImGui::PopID();
    if (!scaled && !tinted) continue;
    session.factors[name] = choice.tint * std::max(choice.scale, 0.0F);
    changed = true;
  }
  if (!changed) return;
  mix_groups(session);
  request.redraw = true;
}

void draw_light(ViewSession& session, GuiRequest& request) {
  if (!ImGui::CollapsingHeader("Light", ImGuiTreeNodeFlags_DefaultOpen)) return;
  ViewSettings& s = session.settings;
  bool changed = ImGui::Checkbox("direct light", &s.direct);
  tooltip("punctual lights with shadow maps, emission, the environment behind");
  if (ImGui::BeginCombo("shadow maps", fmt::format("{}", s.shadow_size).c_str())) {
    for (const int size : {256, 512, 1024, 2048, 4096}) {
      if (ImGui::Selectable(fmt::format("{}", size).c_str(), size == s.shadow_size)) {
        s.shadow_size = size;
        changed = true;
      }
    }
    ImGui::EndCombo();
  }
  changed = ImGui::DragFloat3("constant, lux", &s.constant_e_lux.x, 0.01F, 0, 1e6F) || changed;
  if (!session.environment.empty()) {
    auto turn_deg = float(session.environment_turn_deg);
    if (ImGui::SliderFloat("sky's turn", &turn_deg, -180, 180, "%.1f degrees") && std::isfinite(turn_deg)) {
      session.environment_turn_deg = double(turn_deg);
      changed = true;
    }
  }
  bool planes = s.lookup.guard == Guard::planes;
  if (ImGui::Checkbox("leak guard by planes", &planes)) {
    s.lookup.guard = planes ? Guard::planes : Guard::off;
    changed = true;
  }
  bool cubic = s.lookup.interpolation == Interpolation::tricubic;
  if (ImGui::Checkbox("tricubic", &cubic)) {
    s.lookup.interpolation = cubic ? Interpolation::tricubic : Interpolation::trilinear;
    changed = true;
  }
  ImGui::SameLine();
  bool paper = s.lookup.reconstruction == Reconstruction::paper;
  const bool vectors =
      session.debug_grid == nullptr || std::get<GridAsset>(session.debug_grid->data).gpu.basis == Basis::vectors;
  if (vectors && ImGui::Checkbox("reconstruction of the paper", &paper)) {
    s.lookup.reconstruction = paper ? Reconstruction::paper : Reconstruction::optimal;
    changed = true;
  }
  request.redraw = request.redraw || changed;
}

void draw_picture(ViewSession& session, GuiState& state, GuiRequest& request) {
  if (!ImGui::CollapsingHeader("Picture", ImGuiTreeNodeFlags_DefaultOpen)) return;
  ViewSettings& s = session.settings;
  bool shown = ImGui::SliderFloat("exposure", &s.tone.exposure_stops, -16, 16, "%.2f stops");
  ImGui::SameLine();
  request.find_exposure = ImGui::SmallButton("auto");
  shown = choose("tone curve", s.tone.curve, all_tone_curves, [](ToneCurve) { return std::string(); }) || shown;
  request.redisplay = shown;
  if (ImGui::SliderInt("points a pixel", &state.samples, 1, 64)) request.redraw = true;

  bool changed = choose("show", s.debug, all_debug_views, [&](DebugView view) { return lacks(session, view); });
  tooltip(std::string(summary(s.debug)));
  if (s.debug == DebugView::irradiance || s.debug == DebugView::stored)
    changed = ImGui::Checkbox("false colours", &s.false_color) || changed;
  if (needs_grid(s.debug) && !is_number(s.debug))
    changed = ImGui::SliderFloat("size", &s.glyph_scale, 0.1F, 4) || changed;
  if (is_number(s.debug) || s.false_color) {
    bool fixed = s.range.has_value();
    float range = s.range.value_or(1);
    if (ImGui::Checkbox("range", &fixed)) changed = true;
    ImGui::SameLine();
    changed = ImGui::DragFloat("##range", &range, 0.01F, 1e-6F, 1e6F, "%.3g", ImGuiSliderFlags_Logarithmic) || changed;
    s.range = fixed ? std::optional<float>(range) : std::nullopt;
  }
  if (session.reference) ImGui::TextDisabled("reference %s", session.reference->path.c_str());
  request.redraw = request.redraw || changed;
}

void draw_camera(const ViewSession& session, GuiRequest& request) {
  if (!ImGui::CollapsingHeader("Camera")) return;
  if (ImGui::SmallButton("as at first (Home)")) request.reset_camera = true;
  ImGui::SameLine();
  if (ImGui::SmallButton("all in view (F)")) request.frame_all = true;
  const std::vector<Camera>& cameras = session.world.scene().cameras;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    ImGui::PushID(int(i));
    const std::string label = cameras[i].name.empty() ? fmt::format("camera {}", i) : cameras[i].name;
    if (ImGui::Selectable(label.c_str())) request.camera = int(i);
    ImGui::PopID();
  }
  const V3f at = eye(session.world.camera);
  ImGui::TextDisabled("at %.3g %.3g %.3g m", double(at.x), double(at.y), double(at.z));
}

void draw_assets(const ViewSession& session, const GuiState& state) {
  if (ImGui::CollapsingHeader("Assets")) {
    for (const auto& asset : session.assets) {
      ImGui::Text("%s: %s, %s", asset->label().c_str(), std::string(name_of(asset->kind())).c_str(),
                  format_bytes(asset->bytes()).c_str());
    }
    if (!session.environment.empty()) ImGui::Text("environment %s", session.environment.c_str());
    ImGui::TextDisabled("Drop files here: models, assets, images");
  }
  ImGui::Separator();
  ImGui::Text("%d x %d, CPU %.1f ms, GPU %.1f ms", state.width, state.height, double(state.cpu_ms),
              double(state.gpu_ms));
  ImGui::Text("GPU memory %s", format_bytes(state.gpu_bytes).c_str());
}

void draw_help() {
  if (!ImGui::CollapsingHeader("Mouse and keys")) return;
  ImGui::TextUnformatted(
      "left       drag object on the ground\n"
      "           (Shift: in the picture's plane,\n"
      "           Ctrl: turn it); else orbit\n"
      ", .        turn it         - =  its size\n"
      "right      look around     middle  move\n"
      "wheel      come closer     W A S D Q E  fly\n"
      "F  all in view             Home  first view\n"
      "P  screenshot PNG          Shift+P  EXR, linear\n"
      "Ctrl+P  with this panel    H  hide it\n"
      "X  find exposure           V  next view\n"
      "G  guard                   C  tricubic\n"
      "Space  paths, animation    Esc  quit");
}

}  // namespace

GuiRequest draw_gui(ViewSession& session, GuiState& state) {
  GuiRequest request;
  if (!state.shown) return request;
  ImGui::SetNextWindowPos({8, 8}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({340, std::min(float(state.height) - 16, 760.0F)}, ImGuiCond_FirstUseEver);
  if (ImGui::Begin("ivory")) {
    ImGui::PushItemWidth(170);
    draw_objects(session, state, request);
    draw_animation(session, state);
    draw_light(session, request);
    draw_lamps(session, request);
    draw_groups(session, state, request);
    draw_picture(session, state, request);
    draw_camera(session, request);
    draw_assets(session, state);
    if (ImGui::SmallButton("screenshot (P)")) request.screenshot = true;
    draw_help();
    for (const std::string& message : state.messages) ImGui::TextWrapped("%s", message.c_str());
    ImGui::PopItemWidth();
  }
  ImGui::End();
  return request;
}

}  // namespace ivory
