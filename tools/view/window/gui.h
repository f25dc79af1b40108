// The viewer's panel: what is shown and chosen.
#pragma once

#include <deque>
#include <map>
#include <string>

#include "tools/view/session/session.h"

namespace ivory {

// What sliders and colours of a group of lights say.
struct GroupChoice {
  float scale = 1;
  Rgb tint{1, 1, 1};
};

struct GuiState {
  bool shown = true;
  bool playing = true;       // objects move on their paths
  bool animates = false;     // and the scene as its animation has it
  int samples = 16;          // points a pixel once nothing moves
  std::size_t selected = 0;  // object
  float cpu_ms = 0;          // of the last frame drawn
  float gpu_ms = 0;
  std::size_t gpu_bytes = 0;
  int width = 0;  // of the picture
  int height = 0;
  std::map<std::string, GroupChoice> groups;  // of lights, by name
  std::deque<std::string> messages;           // latest last
};

struct GuiRequest {
  bool redraw = false;     // a choice changed the picture
  bool redisplay = false;  // a choice changed how the same picture is shown
  bool find_exposure = false;
  bool frame_all = false;
  bool reset_camera = false;
  bool screenshot = false;
  int camera = -1;   // of the scene, to look from
  int removed = -1;  // object
};

// Between ImGui's NewFrame and Render. Changes the session as the user does; what needs more than that is requested.
GuiRequest draw_gui(ViewSession& session, GuiState& state);

}  // namespace ivory
