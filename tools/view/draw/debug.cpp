#include "tools/view/draw/debug.h"

namespace ivory {

namespace {

// Sources that give radiance straight away (lobes) have no irradiance to show.
constexpr const char* irradiance_shader = R"(
#define IVORY_OUTPUT
vec3 ivory_output(IvorySurface s) {
#ifdef IVORY_AMBIENT_RADIANCE
  return vec3(0.0);
#else
  return ivory_ambient(s.p, s.ng, s.ns);
#endif
}
)";

constexpr const char* stored_shader = R"(
#define IVORY_OUTPUT
vec3 ivory_output(IvorySurface s) {
  vec3 index;
  float stored;
  IvoryGrid g =
      ivory_grid_level_at(ivory_grid, ivory_grid_guard, s.p + s.ng * ivory_grid.nudge_m, s.ng, index, stored);
  ivec3 vertex = clamp(ivec3(floor(index + 0.5)), ivec3(0), g.size - 1);
  ivec3 texel = ivory_grid_texel(g, ivory_grid_guard, vertex);
  if (texel.x < 0) return vec3(0.0);
  vec3 m[12];
  ivory_vertex_moments(ivory_grid, ivory_grid_volumes, ivory_grid_trust, texel, s.ns, m);
  return ivory_grid_irradiance(ivory_grid, m, s.ns);
}
)";

constexpr const char* bracket_shader = R"(
#define IVORY_OUTPUT
vec3 ivory_output(IvorySurface s) {
  vec3 m[12];
  ivory_lookup_moments(ivory_grid, ivory_grid_volumes, ivory_grid_trust, ivory_grid_guard,
                       s.p + s.ng * ivory_grid.nudge_m, s.ng, s.ns, m);
  vec3 lower, upper;
  ivory_irradiance_bracket(m, s.ns * ivory_grid.local_to_world, lower, upper);
  const vec3 weights = vec3(0.2126, 0.7152, 0.0722);
  float low = dot(lower, weights);
  float high = dot(upper, weights);
  return vec3((high - low) / max(high + low, 1e-20));
}
)";

// The footprint's weights add up to one before trust and guard take theirs.
constexpr const char* kept_shader = R"(
#define IVORY_OUTPUT
vec3 ivory_output(IvorySurface s) {
  vec3 index;
  float stored;
  IvoryGrid g =
      ivory_grid_level_at(ivory_grid, ivory_grid_guard, s.p + s.ng * ivory_grid.nudge_m, s.ng, index, stored);
  IvoryNudged at = IvoryNudged(index, s.ng, g.nudge_m);
  if (IVORY_GRID_INTERPOLATION == ivory_trilinear)
    return vec3(ivory_read_near(g, ivory_grid_trust, ivory_grid_guard, at, stored).seen.kept);
  IvoryFootprint footprint = ivory_make_footprint(g, index, IVORY_GRID_INTERPOLATION);
  footprint.z *= ivory_stored_factor(g, ivory_grid_guard, footprint, 64);
  IvoryPassed passed = ivory_passed_by_guard(g, ivory_grid_trust, ivory_grid_guard, at, footprint, 64);
  return vec3(ivory_yield_wide(g, ivory_grid_trust, ivory_grid_guard, footprint, 64, passed, footprint,
                               IvorySeen(uvec2(0u), 0.0, true)).kept);
}
)";

// Of several levels, what is read without guard is that of the level that counts most.
constexpr const char* guard_shader = R"(
#define IVORY_OUTPUT
vec3 ivory_output(IvorySurface s) {
  vec3 index;
  float stored;
  IvoryGrid g =
      ivory_grid_level_at(ivory_grid, ivory_grid_guard, s.p + s.ng * ivory_grid.nudge_m, s.ng, index, stored);
  vec3 off[12];
  if (IVORY_GRID_LEVELS == 1) {
    ivory_grid_unguarded(g, ivory_grid_volumes, ivory_grid_trust, index, off);
  } else {
    IvoryFootprint footprint = ivory_make_footprint(g, index, ivory_trilinear);
    float kept = 0.0;
    for (int f = 0; f < 12; ++f) off[f] = vec3(0.0);
    for (int e = 0; e < 8; ++e) {
      ivec3 vertex;
      float weight;
      ivory_footprint_entry(g, footprint, e, vertex, weight);
      ivec3 texel = ivory_grid_texel(g, ivory_grid_guard, vertex);
      kept += weight * ivory_texel_trust(ivory_grid_trust, texel);
      weight = texel.x < 0 ? 0.0 : weight;
      for (int f = 0; f < ivory_grid_volume_count(g); ++f)
        off[f] += weight * texelFetch(ivory_grid_volumes, max(texel, ivec3(0)) + ivec3(g.slab[f]), 0).rgb;
    }
    for (int f = 0; f < 12; ++f) off[f] /= max(kept, 1e-4);
  }
  ivory_grid_decode(ivory_grid, s.ns, off);
  vec3 on[12];
  ivory_lookup_moments(ivory_grid, ivory_grid_volumes, ivory_grid_trust, ivory_grid_guard,
                       s.p + s.ng * ivory_grid.nudge_m, s.ng, s.ns, on);
  return ivory_grid_irradiance(ivory_grid, off, s.ns) - ivory_grid_irradiance(ivory_grid, on, s.ns);
}
)";

}  // namespace

std::string surface_debug_shader(DebugView view) {
  switch (view) {
    case DebugView::irradiance:
      return irradiance_shader;
    case DebugView::stored:
      return stored_shader;
    case DebugView::bracket:
      return bracket_shader;
    case DebugView::kept:
      return kept_shader;
    case DebugView::guard:
      return guard_shader;
    default:
      return "";
  }
}

std::string unit_of(DebugView view) {
  switch (view) {
    case DebugView::irradiance:
    case DebugView::stored:
    case DebugView::guard:
      return "lux";
    case DebugView::bracket:
      return "of E";
    case DebugView::kept:
      return "of the weight";
    default:
      return "";
  }
}

}  // namespace ivory
