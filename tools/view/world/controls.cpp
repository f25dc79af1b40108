#include "tools/view/world/controls.h"

#include <algorithm>
#include <cmath>

namespace ivory {

namespace {

// A drag across the picture's height turns by half a turn.
float angle_rad(float pixels, const Imath::V2i& size) { return pi * pixels / float(std::max(size.y, 1)); }

View view_of(const ViewWorld& world, const Imath::V2i& size) {
  return make_view(world.scene().name, world.camera.camera, size.x, size.y);
}

V3f fly_direction(FlyKey key) {
  switch (key) {
    case FlyKey::forward:
      return {0, 0, 1};
    case FlyKey::back:
      return {0, 0, -1};
    case FlyKey::left:
      return {-1, 0, 0};
    case FlyKey::right:
      return {1, 0, 0};
    case FlyKey::up:
      return {0, 1, 0};
    case FlyKey::down:
      return {0, -1, 0};
  }
  return {0, 0, 0};
}

constexpr float step_of_radius = 0.02F;  // a key's press
constexpr float speed_of_radius_per_second = 0.5F;

}  // namespace

void ViewControls::press(const ViewWorld& world, MouseButton button, const V2f& pixel, const Imath::V2i& size,
                         DragMode mode) {
  held_ = button;
  last_ = pixel;
  drag_.reset();
  turns_ = false;
  if (button != MouseButton::left) return;
  const View view = view_of(world, size);
  const std::optional<Pick> found = pick(world, make_ray(view, pixel));
  if (!found || !world.objects[found->object].moves) return;
  selected_ = found->object;
  turns_ = mode == DragMode::turn;
  if (turns_) return;
  drag_ = begin_drag(view, found->point_m, world.objects[selected_].offset_m,
                     mode == DragMode::plane ? DragPlane::view : DragPlane::ground, 4 * world.radius_m);
}

void ViewControls::release(MouseButton button) {
  if (held_ != button) return;
  held_.reset();
  drag_.reset();
  turns_ = false;
}

bool ViewControls::move(ViewWorld& world, const V2f& pixel, const Imath::V2i& size) {
  const V2f by = pixel - last_;
  last_ = pixel;
  if (!held_ || by == V2f(0, 0)) return false;
  switch (*held_) {
    case MouseButton::left:
      if (turns_) {
        if (selected_ >= world.objects.size()) return false;
        // To the right brings what is in front to the right.
        V3f& turn_deg = world.objects[selected_].turn_deg;
        turn_deg.y = std::remainder(turn_deg.y + angle_rad(by.x, size) * (180 / pi), 360.0F);
      } else if (!drag_) {
        world.camera = orbit(world.camera, -angle_rad(by.x, size), angle_rad(by.y, size));
      } else if (selected_ < world.objects.size()) {
        const std::optional<V3f> offset = drag_to(*drag_, view_of(world, size), pixel);
        if (!offset) return false;
        world.objects[selected_].offset_m = *offset;
      }
      return true;
    case MouseButton::right:
      world.camera = look(world.camera, 0.5F * angle_rad(-by.x, size), 0.5F * angle_rad(-by.y, size));
      return true;
    case MouseButton::middle: {
      // What lies at the pivot's depth follows the mouse.
      const View view = view_of(world, size);
      const float depth = view.perspective ? world.camera.pivot_distance_m : 1;
      const float pixel_m = 2 * view.up.length() * depth / float(std::max(size.y, 1));
      world.camera = fly(world.camera, V3f(-by.x * pixel_m, by.y * pixel_m, 0));
      return true;
    }
  }
  return false;
}

bool ViewControls::scroll(ViewWorld& world, float notches) {
  if (notches == 0) return false;
  world.camera = dolly(world.camera, std::pow(0.9F, std::clamp(notches, -20.0F, 20.0F)));
  return true;
}

bool ViewControls::press(ViewWorld& world, FlyKey key) {
  flying_[std::size_t(key)] = true;
  world.camera = fly(world.camera, fly_direction(key) * (step_of_radius * world.radius_m));
  return true;
}

void ViewControls::release(FlyKey key) { flying_[std::size_t(key)] = false; }

bool ViewControls::flies() const {
  return std::any_of(flying_.begin(), flying_.end(), [](bool on) { return on; });
}

bool ViewControls::advance(ViewWorld& world, float seconds, bool fast) {
  if (!flies()) return false;
  V3f direction(0, 0, 0);
  for (std::size_t i = 0; i < flying_.size(); ++i) {
    if (flying_[i]) direction += fly_direction(FlyKey(i));
  }
  // A frame that took long is not to throw the camera out of the scene.
  const float time = std::min(seconds, 0.1F);
  world.camera =
      fly(world.camera, direction * (speed_of_radius_per_second * world.radius_m * time * (fast ? 4.0F : 1.0F)));
  return true;
}

void ViewControls::release_all() {
  flying_.fill(false);
  turns_ = false;
  held_.reset();
  drag_.reset();
}

}  // namespace ivory
