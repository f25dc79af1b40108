// The scene's punctual lights as the user has them: moved, dimmed, coloured, on or off.
#pragma once

#include <string>
#include <vector>

#include "grid/base/types.h"
#include "runtime/renderer/punctual_light.h"

namespace ivory {

struct ViewSession;

struct ViewLamp {
  std::string name;  // of its node; a number where that has none
  bool on = true;
  float scale = 1;
  Rgb tint{1, 1, 1};
  V3f offset_m{0, 0, 0};  // from where the scene has it
  Rgb of_group{1, 1, 1};  // by the groups of a grid

  bool changed() const;  // by the user
};

// One a punctual light of the scene, in its order.
std::vector<ViewLamp> lamps_of(const ViewSession& session);

// "NAME=SCALE", "NAME=SCALE,R,G,B" or "NAME=SCALE,R,G,B,X,Y,Z": brightness, colour, metres. Throws UsageError for other
// texts and names of no lamp.
void change_lamp(ViewSession& session, const std::string& text);

// The strongest of the scene's lights as session.lamps have them, for the frames to come. Says once that grids keep the
// light of lamps as it was baked, where one holds any and a lamp is changed.
void shine(ViewSession& session);

}  // namespace ivory
