// From linear light, or numbers, to what a display shows.
#pragma once

#include "grid/base/names.h"
#include "runtime/gl/gl.h"
#include "tools/view/draw/colormap.h"

namespace ivory {

enum class ToneCurve {
  neutral,   // Khronos PBR Neutral, as ivory render's pictures have it
  linear,    // cut off at white
  reinhard,  // L / (1 + L) on luminance (Reinhard et al., "Photographic Tone Reproduction for Digital Images", 2002,
             // eq. 3)
  aces,      // Narkowicz' fit to ACES, "ACES Filmic Tone Mapping Curve", 2015
};
template <>
inline constexpr auto name_table<ToneCurve> = make_name_table<ToneCurve>("tone curve",
                                                                         {{ToneCurve::neutral, "neutral"},
                                                                          {ToneCurve::linear, "linear"},
                                                                          {ToneCurve::reinhard, "reinhard"},
                                                                          {ToneCurve::aces, "aces"}});
inline constexpr auto all_tone_curves = values_of<ToneCurve>();

struct ToneParams {
  ToneCurve curve = ToneCurve::neutral;
  float exposure_stops = 0;
};

// Which numbers the colours run over.
struct ColorRange {
  float least = 0;
  float greatest = 1;
  bool is_signed = false;  // blue to red
};

class DisplayPass {
 public:
  DisplayPass();

  // Each draws over the whole bound framebuffer. `picture` holds linear light, or numbers whose luminance is shown;
  // where its alpha is zero nothing was drawn: black there.
  void draw_tone_mapped(const gl::Texture& picture, const ToneParams& tone);
  void draw_false_color(const gl::Texture& picture, const ColorRange& range);
  // Luminance of picture minus reference, both linear; or, where the reference holds display values, of their display
  // values, the picture's by `tone`.
  void draw_difference(const gl::Texture& picture, const gl::Texture& reference, bool reference_is_display,
                       const ToneParams& tone, const ColorRange& range);

 private:
  void set_tone(const ToneParams& tone);
  void set_range(const ColorRange& range);
  void draw(const gl::Texture& picture, int mode);

  gl::Program program_;
  gl::VertexArray no_vertices_;
};

}  // namespace ivory
