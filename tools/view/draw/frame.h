// Draws a session: points of a picture, then what the display shows of their mean.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "runtime/renderer/renderer.h"
#include "tools/view/draw/overlay.h"
#include "tools/view/draw/target.h"
#include "tools/view/session/session.h"

namespace ivory {

// Place of point i (from 0) within a pixel, less its middle, in pixels: each coordinate in [-1/2, 1/2), (0, 0) for the
// first. However many are taken, they are spread evenly.
V2f pixel_point(int i);

class ViewFrame {
 public:
  // Point i of each pixel (pixel_point()), added to the target's mean; lights with extent shine from other points of
  // theirs for each i. Throws ParameterError where the debug view lacks a grid or reference, Error as the runtime does.
  // Notes of the session say which lights cast no shadow.
  void draw_point(ViewSession& session, ViewTarget& target, int i);

  // From the target's mean to its display picture: tone-mapped, or in false colours over color_range().
  void draw_display(const ViewSession& session, ViewTarget& target);

  // The false colours' range now: the user's, or found from the target's mean (which stalls until it is drawn).
  ColorRange color_range(const ViewSession& session, const ViewTarget& target) const;
  static bool is_false_color(const ViewSettings& settings);

  std::size_t bytes() const;

 private:
  // Lights with their shadows, and what those were drawn of.
  struct Shadows {
    LightSet lights;
    std::vector<Placement> places;  // of the objects
    double sky_deg = 0;             // turn of the environment
    int size = 0;
    int version = 0;  // of the session's lights
    int sample = 0;   // of lights with extent
  };
  // True where they were drawn anew.
  bool update(Shadows& shadows, const ViewSession& session, int size, int sample,
              const std::function<std::vector<RuntimeLight>(std::span<const Placement>)>& lights);
  void update_punctual(ViewSession& session);
  void add_extended(const ViewSession& session, ViewTarget& target, int i, FrameParams frame,
                    std::vector<DrawItem> items, std::span<const std::size_t> objects);

  Renderer renderer_;
  Shadows punctual_;
  std::map<ExtendedKind, Shadows> extended_;
  int unshadowed_ = 0;  // lights without a shadow that the user was told of
  OverlayPass overlay_;
  DisplayPass display_;
};

}  // namespace ivory
