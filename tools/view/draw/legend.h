// Text and scales over a picture, by Dear ImGui, with a window or without.
#pragma once

#include <string>

#include "tools/view/draw/display.h"

struct ImDrawList;

namespace ivory {

// The colours with their numbers and a title, at the lower left of a picture of that height in pixels.
void draw_legend(ImDrawList& list, const ColorRange& range, const std::string& title, int height);

// ImGui without a window, for pictures that carry a legend.
class LegendPainter {
 public:
  LegendPainter();
  ~LegendPainter();
  LegendPainter(const LegendPainter&) = delete;
  LegendPainter& operator=(const LegendPainter&) = delete;

  // Draws into the bound framebuffer of that size.
  void draw(const ColorRange& range, const std::string& title, int width, int height);
};

}  // namespace ivory
