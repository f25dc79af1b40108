// GLFW's numbers of keys and buttons that move the camera.
#pragma once

#include <optional>

#include "tools/view/world/controls.h"

namespace ivory {

std::optional<FlyKey> fly_key(int key);
std::optional<MouseButton> mouse_button(int button);

}  // namespace ivory
