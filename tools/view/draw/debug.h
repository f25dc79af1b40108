// Debug views that are painted on the surfaces: numbers in place of radiance.
#pragma once

#include <string>

#include "tools/view/session/settings.h"

namespace ivory {

// GLSL for FrameParams::output_shader that shows the view; empty for views that are not painted on surfaces. Views of a
// grid (needs_grid()) read it through the items' ambient source: give all items the grid's, whatever lights them
// otherwise.
std::string surface_debug_shader(DebugView view);

// What the numbers are: "lux", "share".
std::string unit_of(DebugView view);

}  // namespace ivory
