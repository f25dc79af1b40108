// The panel's parts for what plays and shines: the scene's animation, and its lamps.
#pragma once

#include "tools/view/window/gui.h"

namespace ivory {

// As draw_gui(); nothing where the scene has none.
void draw_animation(ViewSession& session, GuiState& state);
void draw_lamps(ViewSession& session, GuiRequest& request);

}  // namespace ivory
