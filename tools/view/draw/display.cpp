#include "tools/view/draw/display.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "grid/base/error.h"
#include "tools/view/draw/target.h"

namespace ivory {

namespace {

// neutral() is the twin of tone_map() in tracer/core/film.cpp. aces() has the constants of Narkowicz' article, and the
// factor of 0.6 by which, as it says, ACES' own exposure comes out.
constexpr const char* fragment_shader = R"(
uniform sampler2D picture;
uniform sampler2D reference;
uniform int mode;     // 0 tone-mapped, 1 false colour, 2 difference, 3 difference of display values
uniform int curve;    // as ToneCurve
uniform float scale;  // 2^stops
uniform float least;
uniform float greatest;
uniform vec4 colors[17];
out vec4 display;

float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

vec3 neutral(vec3 linear) {
  const float start = 0.8 - 0.04;
  float lowest = min(linear.r, min(linear.g, linear.b));
  float offset = lowest < 0.08 ? lowest - 6.25 * lowest * lowest : 0.04;
  vec3 color = linear - offset;
  float peak = max(color.r, max(color.g, color.b));
  if (peak < start) return color;
  float range = 1.0 - start;
  float new_peak = 1.0 - range * range / (peak + range - start);
  color *= new_peak / peak;
  float white = 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0);
  return mix(color, vec3(new_peak), white);
}

vec3 aces(vec3 x) {
  x *= 0.6;
  return (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14);
}

vec3 tone_mapped(vec3 linear) {
  if (curve == 0) return neutral(linear);
  if (curve == 2) return linear / (1.0 + max(luminance(linear), 0.0));
  if (curve == 3) return aces(max(linear, 0.0));
  return linear;
}

// IEC 61966-2-1.
vec3 srgb(vec3 linear) {
  vec3 x = clamp(linear, 0.0, 1.0);
  return mix(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}

vec3 color_of(float value) {
  float at = clamp((value - least) / (greatest - least), 0.0, 1.0) * 16.0;
  int below = min(int(at), 15);
  return mix(colors[below].rgb, colors[below + 1].rgb, at - float(below));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 value = texelFetch(picture, pixel, 0);
  vec3 shown = srgb(tone_mapped(value.rgb * scale));
  // What mean of several points covers a pixel in part is divided by its share.
  vec3 number = value.a > 0.0 ? value.rgb / value.a : vec3(0.0);
  if (mode == 1) shown = value.a > 0.0 ? color_of(luminance(number)) : vec3(0.0);
  if (mode == 2) shown = color_of(luminance(value.rgb - texelFetch(reference, pixel, 0).rgb));
  if (mode == 3) shown = color_of(luminance(shown - texelFetch(reference, pixel, 0).rgb));
  display = vec4(shown, 1.0);
}
)";

enum Mode { tone_mapped = 0, false_color = 1, difference = 2, display_difference = 3 };

}  // namespace

DisplayPass::DisplayPass()
    : program_(gl::make_program("display", full_picture_vertex_shader, fragment_shader)),
      no_vertices_(gl::make<gl::Kind::vertex_array>()) {}

void DisplayPass::set_tone(const ToneParams& tone) {
  program_.set("curve", int(tone.curve));
  program_.set("scale", std::exp2(tone.exposure_stops));
}

void DisplayPass::set_range(const ColorRange& range) {
  const ColorMap& map = range.is_signed ? signed_colors() : sequential_colors();
  std::array<V4f, 17> colors;
  std::transform(map.begin(), map.end(), colors.begin(), [](const V3f& c) { return V4f(c.x, c.y, c.z, 1); });
  program_.set("colors[0]", colors.data(), int(colors.size()));
  program_.set("least", range.least);
  program_.set("greatest", std::max(range.greatest, range.least + 1e-20F));
}

void DisplayPass::draw(const gl::Texture& picture, int mode) {
  program_.set("mode", mode);
  program_.set("picture", 0);
  gl::bind(picture, 0);
  draw_full_picture(no_vertices_);
}

void DisplayPass::draw_tone_mapped(const gl::Texture& picture, const ToneParams& tone) {
  set_tone(tone);
  // Samplers of modes that do not run still need a texture of their kind.
  gl::bind(picture, 1);
  program_.set("reference", 1);
  draw(picture, tone_mapped);
}

void DisplayPass::draw_false_color(const gl::Texture& picture, const ColorRange& range) {
  set_range(range);
  gl::bind(picture, 1);
  program_.set("reference", 1);
  draw(picture, false_color);
}

void DisplayPass::draw_difference(const gl::Texture& picture, const gl::Texture& reference, bool reference_is_display,
                                  const ToneParams& tone, const ColorRange& range) {
  set_tone(tone);
  set_range(range);
  gl::bind(reference, 1);
  program_.set("reference", 1);
  draw(picture, reference_is_display ? display_difference : difference);
}

}  // namespace ivory
