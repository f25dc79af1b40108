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
  vec3 index = ivory_grid_to_index(ivory_grid, s.p + s.ng * ivory_grid.nudge_m);
  ivec3 vertex = clamp(ivec3(floor(index + 0.5)), ivec3(0), ivory_grid.size - 1);
  vec3 m[12];
  ivory_vertex_moments(ivory_grid, ivory_grid_volumes, ivory_grid_trust, vertex, s.ns, m);
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
  IvoryGrid g = ivory_grid;
  vec3 index = ivory_grid_to_index(g, s.p + s.ng * g.nudge_m);
  IvoryFootprint footprint = ivory_make_footprint(g, index, IVORY_GRID_INTERPOLATION);
  IvoryPassed passed = ivory_passed_by_guard(g, ivory_grid_trust, ivory_grid_guard, index, s.ng, footprint,
                                             ivory_footprint_count(footprint));
  if (IVORY_GRID_INTERPOLATION == ivory_trilinear)
    return vec3(ivory_yield_near(g, ivory_grid_trust, ivory_grid_guard, footprint, passed).kept);
  return vec3(ivory_yield_wide(g, ivory_grid_trust, ivory_grid_guard, footprint, 64, passed, footprint,
                               IvorySeen(uvec2(0u), 0.0, true)).kept);
}
)";

constexpr const char* guard_shader = R"(
#define IVORY_OUTPUT
vec3 ivory_output(IvorySurface s) {
  vec3 index = ivory_grid_to_index(ivory_grid, s.p + s.ng * ivory_grid.nudge_m);
  vec3 off[12];
  ivory_grid_unguarded(ivory_grid, ivory_grid_volumes, ivory_grid_trust, index, off);
  ivory_grid_decode(ivory_grid, s.ns, off);
  vec3 on[12];
  ivory_grid_guarded(ivory_grid, ivory_grid_volumes, ivory_grid_trust, ivory_grid_guard, index, s.ng, on);
  ivory_grid_decode(ivory_grid, s.ns, on);
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
