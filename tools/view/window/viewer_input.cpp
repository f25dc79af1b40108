// What mouse, keys and dropped files do.
#include <algorithm>
#include <cmath>

#include <imgui.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "grid/base/error.h"
#include "tools/view/session/light.h"
#include "tools/view/window/keys.h"
#include "tools/view/window/viewer.h"
#include "tracer/core/camera.h"

namespace ivory {

void Viewer::on(const MouseButtonEvent& e) {
  const std::optional<MouseButton> button = mouse_button(e.button);
  if (!button || !target_) return;
  if (!e.down) {
    controls_.release(*button);
  } else if (!(state_.shown && ImGui::GetIO().WantCaptureMouse)) {
    controls_.press(session_->world, *button, e.pixel, window_.size(),
                    e.control ? DragMode::turn
                    : e.shift ? DragMode::plane
                              : DragMode::ground);
  }
}

void Viewer::on(const MouseMoveEvent& e) {
  dirty_ = controls_.move(session_->world, e.pixel, window_.size()) || dirty_;
}
void Viewer::on(const ScrollEvent& e) {
  if (!(state_.shown && ImGui::GetIO().WantCaptureMouse))
    dirty_ = controls_.scroll(session_->world, e.notches) || dirty_;
}

void Viewer::on(const FocusLostEvent&) { controls_.release_all(); }
void Viewer::on(const DropEvent& e) {
  for (const std::string& path : e.paths) {
    attempt([&] {
      // A model stands where it was let go.
      const View view = make_view(run_.input.scene, session_->world.camera.camera, window_.size().x, window_.size().y);
      const std::optional<Pick> under = pick(session_->world, make_ray(view, e.pixel));
      say(add_file(*session_, path, under ? under->point_m : pivot(session_->world.camera), window_.size()));
    });
  }
  dirty_ = true;
}

void Viewer::on(const KeyEvent& e) {
  if (const std::optional<FlyKey> key = fly_key(e.key); key && (!e.control || !e.down)) {
    fast_ = e.shift;
    if (!e.down) {
      controls_.release(*key);
    } else if (!ImGui::GetIO().WantTextInput) {
      dirty_ = controls_.press(session_->world, *key) || dirty_;
    }
    return;
  }
  if (!e.down || ImGui::GetIO().WantTextInput) return;
  press(e);
}

void Viewer::press(const KeyEvent& e) {
  ViewSettings& s = session_->settings;
  switch (e.key) {
    case GLFW_KEY_ESCAPE:
      window_.close();
      return;
    case GLFW_KEY_P:
      if (e.control) {
        screenshot_with_panel_ = true;
      } else {
        attempt([&] { screenshot(e.shift ? ".exr" : ".png"); });
      }
      return;
    case GLFW_KEY_H:
      state_.shown = !state_.shown;
      return;
    case GLFW_KEY_F:
      frame_all();
      return;
    case GLFW_KEY_HOME:
      reset_camera();
      return;
    case GLFW_KEY_X:
      find_exposure_now();
      return;
    case GLFW_KEY_SPACE:
      // Both at once; where an animation could play, it is what is looked at.
      state_.playing = session_->animation ? !state_.animates : !state_.playing;
      state_.animates = session_->animation && state_.playing;
      return;
    case GLFW_KEY_DELETE:
      if (controls_.selected() > 0) remove(controls_.selected());
      return;
    case GLFW_KEY_COMMA:
      if (!turn_selected(5)) return;
      break;
    case GLFW_KEY_PERIOD:
      if (!turn_selected(-5)) return;
      break;
    case GLFW_KEY_MINUS:
      if (!scale_selected(1 / 1.1F)) return;
      break;
    case GLFW_KEY_EQUAL:
      if (!scale_selected(1.1F)) return;
      break;
    case GLFW_KEY_G:
      s.lookup.guard = s.lookup.guard == Guard::planes ? Guard::off : Guard::planes;
      break;
    case GLFW_KEY_C:
      s.lookup.interpolation =
          s.lookup.interpolation == Interpolation::trilinear ? Interpolation::tricubic : Interpolation::trilinear;
      break;
    case GLFW_KEY_V:
      show_next_view();
      break;
    default:
      return;
  }
  dirty_ = true;
}

ViewObject* Viewer::selected_object() {
  std::vector<ViewObject>& objects = session_->world.objects;
  const std::size_t selected = controls_.selected();
  return selected < objects.size() && objects[selected].moves ? &objects[selected] : nullptr;
}

bool Viewer::turn_selected(float degrees) {
  ViewObject* object = selected_object();
  if (object != nullptr) object->turn_deg.y = std::remainder(object->turn_deg.y + degrees, 360.0F);
  return object != nullptr;
}

bool Viewer::scale_selected(float factor) {
  ViewObject* object = selected_object();
  if (object != nullptr) object->scale = std::clamp(object->scale * factor, 1e-3F, 1e3F);
  return object != nullptr;
}

// The next one that can be shown.
void Viewer::show_next_view() {
  DebugView& view = session_->settings.debug;
  std::size_t i = std::size_t(view);
  do i = (i + 1) % all_debug_views.size();
  while (!lacks(*session_, all_debug_views[i]).empty());
  view = all_debug_views[i];
}

}  // namespace ivory
