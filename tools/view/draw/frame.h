// Draws a session: points of a picture, then what the display shows of their mean.
#pragma once

#include <map>
#include <optional>
#include <string>

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
  // One point of each pixel, at `shift` (pixels) from its middle, added to the target's mean. Throws ParameterError
  // where the debug view lacks a grid or reference, Error as the runtime does. Notes of the session say which lights
  // cast no shadow.
  void draw_point(ViewSession& session, ViewTarget& target, const V2f& shift);

  // From the target's mean to its display picture: tone-mapped, or in false colours over color_range().
  void draw_display(const ViewSession& session, ViewTarget& target);

  // The false colours' range now: the user's, or found from the target's mean (which stalls until it is drawn).
  ColorRange color_range(const ViewSession& session, const ViewTarget& target) const;
  static bool is_false_color(const ViewSettings& settings);

  std::size_t bytes() const { return shadows_.bytes(); }

 private:
  void update_shadows(ViewSession& session);

  Renderer renderer_;
  LightSet shadows_;
  std::vector<V3f> shadows_of_;  // places of the objects that the shadow maps show
  int shadow_size_ = 0;
  int unshadowed_ = 0;  // lights without a shadow that the user was told of
  OverlayPass overlay_;
  DisplayPass display_;
};

}  // namespace ivory
