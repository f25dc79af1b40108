// Mouse and keys to moves of the camera and of objects. Knows no window: events come as plain numbers.
#pragma once

#include <array>
#include <optional>

#include "tools/view/world/drag.h"
#include "tools/view/world/world.h"

namespace ivory {

enum class MouseButton { left, right, middle };
enum class FlyKey { forward, back, left, right, up, down };

// How the left button drags an object: over the ground, in the picture's plane, or on the spot, about +Y.
enum class DragMode { ground, plane, turn };

// Left: drags the object under the mouse as its mode says; orbits where there is none. Right: looks around. Middle:
// moves the camera in the picture's plane. Wheel: comes closer.
class ViewControls {
 public:
  // All pixels are the picture's, from its upper left corner. True where the picture changed.
  void press(const ViewWorld& world, MouseButton button, const V2f& pixel, const Imath::V2i& size, DragMode mode);
  void release(MouseButton button);
  bool move(ViewWorld& world, const V2f& pixel, const Imath::V2i& size);
  bool scroll(ViewWorld& world, float notches);

  // A key's press moves a step at once, so that none is too short; then it flies on until release.
  bool press(ViewWorld& world, FlyKey key);
  void release(FlyKey key);
  bool advance(ViewWorld& world, float seconds, bool fast);
  bool flies() const;
  void release_all();

  // The object that was clicked last; 0, the scene, for none.
  std::size_t selected() const { return selected_; }
  void select(std::size_t object) { selected_ = object; }

 private:
  std::optional<MouseButton> held_;
  V2f last_{0, 0};
  std::optional<Drag> drag_;
  bool turns_ = false;  // the selected object, as the mouse goes to the side
  std::size_t selected_ = 0;
  std::array<bool, 6> flying_{};
};

}  // namespace ivory
