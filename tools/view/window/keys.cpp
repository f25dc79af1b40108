#include "tools/view/window/keys.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace ivory {

std::optional<FlyKey> fly_key(int key) {
  switch (key) {
    case GLFW_KEY_W:
      return FlyKey::forward;
    case GLFW_KEY_S:
      return FlyKey::back;
    case GLFW_KEY_A:
      return FlyKey::left;
    case GLFW_KEY_D:
      return FlyKey::right;
    case GLFW_KEY_E:
      return FlyKey::up;
    case GLFW_KEY_Q:
      return FlyKey::down;
    default:
      return std::nullopt;
  }
}

std::optional<MouseButton> mouse_button(int button) {
  switch (button) {
    case GLFW_MOUSE_BUTTON_LEFT:
      return MouseButton::left;
    case GLFW_MOUSE_BUTTON_RIGHT:
      return MouseButton::right;
    case GLFW_MOUSE_BUTTON_MIDDLE:
      return MouseButton::middle;
    default:
      return std::nullopt;
  }
}

}  // namespace ivory
