#include "tools/view/draw/overlay.h"

#include <algorithm>
#include <cmath>

#include "grid/base/error.h"
#include "runtime/gl/check.h"

namespace ivory {

namespace {

// In grids of several levels the shown vertices are every step-th texel of their atlas, whatever level they are of.
//
// An instance is one of the shown vertices (of spheres) or one of its six vectors; four corners of a strip each.
constexpr const char* instance_functions = R"(
uniform mat4 clip_from_world;
uniform vec4 eye;        // w 1: position; w 0: direction towards an orthographic eye
uniform ivec3 shown;     // vertices an axis
uniform int vertex_step;
uniform float unit_m;    // radius of spheres; half width of needles
uniform sampler3D visible_fraction;

uniform usampler3D brick_places;  // of several levels: where each of the atlas' bricks stands

ivec3 vertex_of(int i) { return ivec3(i % shown.x, i / shown.x % shown.y, i / (shown.x * shown.y)) * vertex_step; }
vec2 corner() { return vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0; }
const vec4 nowhere = vec4(0.0, 0.0, 2.0, 1.0);
)";

// A square behind the sphere's outline as the eye sees it. For an eye at distance d the outline's cone meets the plane
// through the centre in a circle of radius r / sqrt(1 - (r/d)^2).
// After ambient/grid.glsl. The vertex of a texel: its position, and how much smaller its level's spacing is; 0 where
// the atlas holds none.
constexpr const char* place_function = R"(
vec3 place_of(ivec3 texel, out float size) {
  size = 1.0;
  if (IVORY_GRID_LEVELS == 1) return ivory_grid_vertex_position(ivory_grid, texel);
  ivec4 place = ivec4(texelFetch(brick_places, texel >> 2, 0));
  IvoryGrid level = ivory_grid_level(ivory_grid, max(place.w - 1, 0));
  ivec3 vertex = (place.xyz << 2) + (texel & 3);
  bool is_there = place.w > 0 && all(lessThan(vertex, level.size));
  size = is_there ? exp2(float(1 - place.w)) : 0.0;
  return ivory_grid_vertex_position(level, vertex);
}
)";

constexpr const char* sphere_vertex = R"(
out vec3 square;
flat out vec3 center;
flat out ivec3 vertex;
flat out float radius;
void main() {
  vertex = vertex_of(gl_InstanceID);
  float size;
  center = place_of(vertex, size);
  radius = unit_m * size;
  vec3 to_eye = eye.w > 0.5 ? eye.xyz - center : eye.xyz;
  float d = length(to_eye);
  bool inside = eye.w > 0.5 && d < 1.5 * radius;
  bool empty = texelFetch(visible_fraction, vertex, 0).r <= 0.0;
  vec3 axis = to_eye / d;
  vec3 right = normalize(cross(abs(axis.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0), axis));
  float k = radius / d;
  float r = eye.w > 0.5 ? radius * inversesqrt(max(1.0 - k * k, 1e-3)) : radius;
  square = center + (right * corner().x + cross(axis, right) * corner().y) * r;
  gl_Position = inside || size == 0.0 || (empty && !show_empty) ? nowhere : clip_from_world * vec4(square, 1.0);
}
)";

constexpr const char* sphere_fragment = R"(
#include "ambient/grid.glsl"
#include "base/pi.glsl"
uniform mat4 clip_from_world;
uniform vec4 eye;
uniform sampler3D visible_fraction;
uniform vec4 colors[17];
uniform float brightness;  // of display colours, nits
in vec3 square;
flat in vec3 center;
flat in ivec3 vertex;
flat in float radius;
out vec4 fragment;

vec3 color_of(float x) {
  float at = clamp(x, 0.0, 1.0) * 16.0;
  int below = min(int(at), 15);
  return mix(colors[below].rgb, colors[below + 1].rgb, at - float(below));
}

void main() {
  vec3 w = eye.w > 0.5 ? normalize(square - eye.xyz) : -eye.xyz;
  vec3 start = square - w * (2.0 * radius);
  vec3 o = start - center;
  float b = dot(o, w);
  float discriminant = b * b - dot(o, o) + radius * radius;
  if (discriminant < 0.0) discard;
  vec3 p = start + w * (-b - sqrt(discriminant));
  vec3 n = normalize(p - center);
  vec4 clip = clip_from_world * vec4(p, 1.0);
  gl_FragDepth = clip.z / clip.w * 0.5 + 0.5;
  if (show_empty) {
    float seen = texelFetch(visible_fraction, vertex, 0).r;
    vec3 color = seen > 0.0 ? color_of(seen) : vec3(0.7, 0.0, 0.0);
    fragment = vec4(color * (brightness * (0.6 + 0.4 * max(-dot(n, w), 0.0))), 1.0);
  } else {
    vec3 m[12];
    ivory_vertex_moments(ivory_grid, ivory_grid_volumes, ivory_grid_trust, vertex, n, m);
    fragment = vec4(ivory_grid_irradiance(ivory_grid, m, n) / ivory_pi, 1.0);
  }
}
)";

// A needle from the vertex towards the light, widest at the vertex. The hemispheres' vectors from the moments:
// I_{+i} = (F + D_i) / 2, I_{-i} = (F - D_i) / 2.
constexpr const char* vector_vertex = R"(
uniform float length_scale;  // m a lux
uniform float longest_m;
flat out vec3 color;
void main() {
  ivec3 vertex = vertex_of(gl_InstanceID / 6);
  int axis = gl_InstanceID % 6 / 2;
  float side = (gl_InstanceID & 1) == 0 ? 1.0 : -1.0;
  vec3 m[12];
  ivory_vertex_moments(ivory_grid, ivory_grid_volumes, ivory_grid_trust, vertex, m);
  vec3 v;
  for (int i = 0; i < 3; ++i)
    v[i] = dot(m[i] + side * m[3 + 3 * axis + i], vec3(0.2126, 0.7152, 0.0722)) * 0.5;
  float lux = length(v);
  float size;
  vec3 from = place_of(vertex, size);
  vec3 direction = ivory_grid.local_to_world * (v / max(lux, 1e-30));
  vec3 to_eye = eye.w > 0.5 ? normalize(eye.xyz - from) : eye.xyz;
  vec3 across = cross(direction, to_eye);
  across = dot(across, across) > 1e-12 ? normalize(across) : vec3(0.0);
  float along = (corner().y + 1.0) * 0.5;
  float reach_m = min(lux * length_scale, longest_m) * size;
  vec3 p = from + direction * (reach_m * along) + across * (corner().x * unit_m * size * (1.0 - along));
  color = vec3(axis == 0, axis == 1, axis == 2);
  color = mix(color, vec3(1.0), side > 0.0 ? 0.08 : 0.55);
  gl_Position = lux > 0.0 && size > 0.0 ? clip_from_world * vec4(p, 1.0) : nowhere;
}
)";

constexpr const char* vector_fragment = R"(
uniform float brightness;
flat in vec3 color;
out vec4 fragment;
void main() { fragment = vec4(color * brightness, 1.0); }
)";

int shown_along(int size, int step) { return (size + step - 1) / step; }

// `size` counts texels, which in a grid of one level are its vertices.
V3i shown_vertices(const V3i& size, int step) {
  return {shown_along(size.x, step), shown_along(size.y, step), shown_along(size.z, step)};
}

float least_spacing(const GridFrame& frame) {
  return std::min({frame.spacing_m.x, frame.spacing_m.y, frame.spacing_m.z});
}

// The light that a display colour of linear value 1 takes, so that it comes out so; display values are taken as linear
// here, which only makes them paler.
float brightness_of(const ToneParams& tone) { return 0.75F * std::exp2(-tone.exposure_stops); }

}  // namespace

int automatic_vertex_step(const V3i& size) {
  constexpr std::int64_t most = 20'000;
  for (int step = 1;; ++step) {
    const V3i shown = shown_vertices(size, step);
    if (std::int64_t(shown.x) * shown.y * shown.z <= most) return step;
  }
}

gl::Program& OverlayPass::program(const GridAsset& grid, DebugView view) {
  const bool vectors = view == DebugView::vectors;
  const std::string defines =
      grid_defines(grid.gpu) + "const bool show_empty = " + (view == DebugView::validity ? "true;\n" : "false;\n");
  gl::Program& found = programs_[defines + std::string(name_of(view))];
  if (!found) {
    found = gl::make_program(std::string(name_of(view)),
                             defines + instance_functions + "#include \"ambient/grid.glsl\"\n" + place_function +
                                 (vectors ? vector_vertex : sphere_vertex),
                             defines + (vectors ? vector_fragment : sphere_fragment));
  }
  return found;
}

void OverlayPass::draw(const GridAsset& grid, const RuntimeCamera& camera, const ViewSettings& settings) {
  const bool vectors = settings.debug == DebugView::vectors;
  if (vectors && grid.gpu.basis != Basis::vectors)
    throw ParameterError("debug", "vectors needs a grid of basis vectors, not " + std::string(name_of(grid.gpu.basis)));
  const GridFrame& frame = grid.gpu.frame;
  const int step = settings.vertex_step > 0 ? settings.vertex_step : automatic_vertex_step(grid.gpu.atlas.size);
  const V3i shown = shown_vertices(grid.gpu.atlas.size, step);
  // Where steps leave out parts of bricks, what is left of them stands no farther apart.
  const float spacing = least_spacing(frame) * (grid.gpu.levels > 1 ? 1.0F : float(step));
  if (!no_vertices_) no_vertices_ = gl::make<gl::Kind::vertex_array>();

  gl::Program& p = program(grid, settings.debug);
  const int unit = bind(grid.gpu, p, 0);
  gl::bind(grid.visible_fraction, unit);
  p.set("visible_fraction", unit);
  gl::bind(grid.gpu.levels > 1 ? grid.brick_places : grid.gpu.guard, unit + 1);  // samplers of two types share no unit
  p.set("brick_places", unit + 1);
  p.set("clip_from_world", camera.clip_from_world);
  const V3f eye = camera.perspective ? camera.position_m : -camera.forward;
  p.set("eye", V4f(eye.x, eye.y, eye.z, camera.perspective ? 1.0F : 0.0F));
  p.set("shown", shown);
  p.set("vertex_step", step);
  p.set("unit_m", (vectors ? 0.03F : 0.14F) * settings.glyph_scale * spacing);
  p.set("brightness", brightness_of(settings.tone));
  std::array<V4f, 17> colors;
  std::transform(sequential_colors().begin(), sequential_colors().end(), colors.begin(),
                 [](const V3f& c) { return V4f(c.x, c.y, c.z, 1); });
  p.set("colors[0]", colors.data(), int(colors.size()));
  p.set("length_scale", 0.45F * spacing * settings.glyph_scale / std::max(grid.typical_vector_lux, 1e-20F));
  p.set("longest_m", spacing);

  IVORY_GL(glEnable, GL_DEPTH_TEST);
  IVORY_GL(glDepthFunc, GL_LESS);
  IVORY_GL(glDepthMask, GLboolean(GL_TRUE));
  IVORY_GL(glDisable, GL_CULL_FACE);
  IVORY_GL(glBindVertexArray, no_vertices_.id());
  const int instances = shown.x * shown.y * shown.z * (vectors ? 6 : 1);
  IVORY_GL(glDrawArraysInstanced, GL_TRIANGLE_STRIP, 0, 4, instances);
  IVORY_GL(glBindVertexArray, 0);
  IVORY_GL(glDisable, GL_DEPTH_TEST);
}

}  // namespace ivory
