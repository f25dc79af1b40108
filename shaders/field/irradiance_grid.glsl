// E(p, n) from a baked irradiance grid. Twin of grid/field/irradiance_grid.cpp and grid/field/lookup.cpp;
// runtime/assets/irradiance_grid.h makes the textures and sets the numbers.
//
// Inputs, passed as parameters:
//   IvoryGrid g              the numbers; see the struct
//   sampler3D volumes        RGB16F, linear: one volume a function of the basis, side by side, each vertex's values
//                            times its trust, divided by g.scale
//   sampler3D trust          R16F, linear: min(1, visible fraction / 0.25) a vertex, 0 where nothing is stored
//   usampler3D guard         RGBA32UI, nearest: the vertex's guard record, whose order tells whether it is lit; behind
//                            these the tables of a grid of several levels (field/levels.glsl)
//   vec3 p, ng, n            world position in metres, unit geometric normal on the lit side (0 for a point that lies
//                            before no surface), unit shading normal
// Answers are lux. p may lie anywhere; outside the grid its nearest vertices answer. With guard, what no vertex sees is
// dark.
//
// Textures have a texel a vertex: (i, j, k) of vertex (i, j, k) in a grid of one level, else that of
// ivory_grid_texel().
//
// The choices among g (basis, form, guard, interpolation, reconstruction, levels) may be compiled in instead of read from the
// struct, which saves what a driver makes of branches not taken: #define IVORY_GRID_BASIS and so on before this file
// (runtime/assets/irradiance_grid.h: grid_defines()).
#include "field/basis.glsl"
#include "field/yield.glsl"

// Where the vertices that see p hold less of the weight than this, others help.
const float ivory_grid_enough_weight = 0.25;

int ivory_grid_volume_count(IvoryGrid g) { return ivory_function_count(IVORY_GRID_BASIS); }

// Index coordinates of a world position: vertex (i,j,k) has (i,j,k).
vec3 ivory_grid_to_index(IvoryGrid g, vec3 p) { return ((p - g.origin_m) * g.local_to_world) / g.spacing_m; }
vec3 ivory_grid_vertex_position(IvoryGrid g, ivec3 vertex) {
  return g.origin_m + g.local_to_world * (vec3(vertex) * g.spacing_m);
}

// Volume f, and the trust, filtered at index coordinates within [0, size - 1]. There no filter reaches past the
// outermost vertices' centres, and so none into the neighbouring volume.
vec3 ivory_grid_filtered(IvoryGrid g, sampler3D volumes, int f, vec3 index) {
  return textureLod(volumes, (index + 0.5 + g.slab[f]) * g.texel, 0.0).rgb;
}
float ivory_grid_filtered_trust(IvoryGrid g, sampler3D trust, vec3 index) {
  vec3 size = vec3(IVORY_GRID_LEVELS == 1 ? g.size : textureSize(trust, 0));
  return textureLod(trust, (index + 0.5) / size, 0.0).r;
}

// Without guard the weights are the filter's own: values and trust, each filtered, then divided. Trilinear is one fetch
// a volume. The cubic B-spline is eight: along an axis, w0 and w1 are one linear fetch between their vertices, and w2
// and w3 another (Sigg & Hadwiger, GPU Gems 2, chapter 20). Sums of values times trust, and in `kept` of trust.
void ivory_grid_filter(IvoryGrid g, sampler3D volumes, sampler3D trust, vec3 index, out vec3 m[12], out float kept) {
  vec3 last = vec3(g.size - 1);
  int count = ivory_grid_volume_count(g);
  for (int f = 0; f < 12; ++f) m[f] = vec3(0.0);
  if (IVORY_GRID_INTERPOLATION == ivory_trilinear) {
    vec3 at = IVORY_GRID_LEVELS == 1 ? clamp(index, vec3(0.0), last) : index;  // a place in the atlas
    kept = ivory_grid_filtered_trust(g, trust, at);
    for (int f = 0; f < 12; ++f) {
      if (f < count) m[f] = ivory_grid_filtered(g, volumes, f, at);
    }
    return;
  }
  kept = 0.0;
  if (IVORY_GRID_LEVELS != 1) return;
  IvoryFootprint footprint = ivory_make_footprint(g, index, ivory_tricubic);
  vec3 w1 = vec3(footprint.x.y, footprint.y.y, footprint.z.y);
  vec3 w3 = vec3(footprint.x.w, footprint.y.w, footprint.z.w);
  vec3 low = vec3(footprint.x.x, footprint.y.x, footprint.z.x) + w1;
  vec3 high = vec3(footprint.x.z, footprint.y.z, footprint.z.z) + w3;
  vec3 from = clamp(vec3(footprint.first) + w1 / low, vec3(0.0), last);
  vec3 to = clamp(vec3(footprint.first) + 2.0 + w3 / high, vec3(0.0), last);
  for (int corner = 0; corner < 8; ++corner) {
    bvec3 side = bvec3((corner & 1) != 0, (corner & 2) != 0, (corner & 4) != 0);
    vec3 at = vec3(side.x ? to.x : from.x, side.y ? to.y : from.y, side.z ? to.z : from.z);
    float weight = (side.x ? high.x : low.x) * (side.y ? high.y : low.y) * (side.z ? high.z : low.z);
    kept += weight * ivory_grid_filtered_trust(g, trust, at);
    for (int f = 0; f < 12; ++f) {
      if (f < count) m[f] += weight * ivory_grid_filtered(g, volumes, f, at);
    }
  }
}

// Where next to nothing is trusted the sum stays undivided.
void ivory_grid_unguarded(IvoryGrid g, sampler3D volumes, sampler3D trust, vec3 index, out vec3 m[12]) {
  float kept;
  ivory_grid_filter(g, volumes, trust, index, m, kept);
  float factor = kept < ivory_grid_least_weight ? 1.0 : 1.0 / kept;
  for (int f = 0; f < 12; ++f) m[f] *= factor;
}

// As read_near(): the eight vertices around the point, or around the closer one where what was read does not see that.
// A second round of the loop is for few pixels: beside walls, where they face them, and in the dark.
struct IvoryNear {
  IvoryNudged at;
  IvoryFootprint footprint;
  IvorySeen seen;
};
IvoryNear ivory_read_near(IvoryGrid g, sampler3D trust, usampler3D guard, IvoryNudged at, float stored) {
  IvoryNear near = IvoryNear(at, ivory_make_footprint(g, at.index, ivory_trilinear), IvorySeen(uvec2(0u), 0.0, true));
  bool by_planes = IVORY_GRID_GUARD == ivory_guard_planes;
  bool can_move = by_planes && at.ng != vec3(0.0) && at.off_m > 0.0;
  int rounds = by_planes || IVORY_GRID_INTERPOLATION == ivory_trilinear ? 1 : 0;
  for (int k = 0; k < rounds; ++k) {
    IvoryFootprint eight = ivory_make_footprint(g, at.index, ivory_trilinear);
    if (IVORY_GRID_LEVELS != 1) {
      float factor = ivory_stored_factor(g, guard, eight, k == 0 ? 0 : 8);
      eight.z *= k == 0 ? 1.0 / stored : factor;
    }
    IvoryPassed passed = ivory_passed_by_guard(g, trust, guard, at, eight, 8);
    IvorySeen seen = ivory_yield_near(g, trust, guard, eight, passed);
    bool sees = seen.kept >= ivory_grid_least_weight;
    if (k == 0 || sees) near = IvoryNear(at, eight, seen);
    rounds = k == 0 && can_move && !(sees && ivory_see_closer(passed, seen)) ? 2 : 1;
    at = ivory_closer(g, at);
  }
  return near;
}

// As guarded_level_footprint(): the values of the vertices that see the point. Most points are seen by all of theirs, whose
// weights are then the filter's. The others take a loop over vertices, one fetch a volume each, which costs no more
// than fetching pairs of neighbours of arbitrary weights as one linear fetch between them: that filters eight texels
// for two.
//
// `rounds` is 0 where a point needs none: drivers that turn branches into masks skip the rounds of a loop that no pixel
// of a group needs, but run both sides of a branch.
//
// In one of several levels, `stored` is the trilinear weight of the vertices that it has, by which the others' weights
// are divided; and the filter serves where the eight stand in one brick, side by side in the atlas, as of 64 points 27
// do. Answers whether any vertex sees the point.
bool ivory_grid_guarded(IvoryGrid g, sampler3D volumes, sampler3D trust, usampler3D guard, vec3 index, vec3 ng,
                        float stored, out vec3 m[12]) {
  int count = ivory_grid_volume_count(g);
  IvoryNear eight = ivory_read_near(g, trust, guard, IvoryNudged(index, ng, g.nudge_m), stored);
  IvoryNudged at = eight.at;
  IvoryFootprint near = eight.footprint;
  IvorySeen near_seen = eight.seen;
  if (IVORY_GRID_INTERPOLATION != ivory_trilinear) {
    near = ivory_make_footprint(g, at.index, ivory_tricubic);
    if (IVORY_GRID_LEVELS != 1) near.z *= ivory_stored_factor(g, guard, near, 64);
    IvoryPassed passed = ivory_passed_by_guard(g, trust, guard, at, near, 64);
    near_seen = ivory_seen(passed);
    if (IVORY_GRID_GUARD == ivory_guard_planes)
      near_seen = ivory_yield_wide(g, trust, guard, near, 64, passed, eight.footprint, eight.seen);
    // Facing a wall from free space, all that see the point may stand behind it, where wide footprints do not count.
    if (near_seen.kept < ivory_grid_least_weight && eight.seen.kept >= ivory_grid_least_weight) {
      near = eight.footprint;
      near_seen = eight.seen;
    }
  }
  int near_count = ivory_footprint_count(near);
  bool can_filter = near.wide == (IVORY_GRID_INTERPOLATION == ivory_tricubic);
  vec3 filter_index = at.index;
  if (IVORY_GRID_LEVELS != 1) {
    ivec3 texel = ivory_grid_texel(g, guard, clamp(near.first, ivec3(0), g.size - 1));
    can_filter = can_filter && !near.wide && texel.x >= 0 && all(notEqual(near.first & 3, ivec3(3)));
    vec3 clamped = clamp(at.index, vec3(0.0), vec3(g.size - 1));
    filter_index = vec3(max(texel, ivec3(0))) + clamped - vec3(near.first);
  }
  bool enough = near_seen.kept >= ivory_grid_enough_weight;
  bool filtered = near_seen.all && enough && can_filter;
  // Divided by the trust that the same filter finds: hardware rounds its weights, to the same for both.
  float filtered_kept;
  ivory_grid_filter(g, volumes, trust, filter_index, m, filtered_kept);
  bool empty = near_seen.kept < ivory_grid_least_weight;
  float near_factor = empty ? 0.0 : 1.0 / near_seen.kept;
  for (int f = 0; f < 12; ++f) m[f] *= filtered ? 1.0 / filtered_kept : 0.0;
  int rounds = filtered || empty ? 0 : near_count;

  // Where little weight is kept, the vertices around help out.
  IvoryFootprint wide = near;
  IvorySeen wide_seen = near_seen;
  float wide_factor = 0.0;
  if (IVORY_GRID_INTERPOLATION == ivory_trilinear) {
    wide = ivory_make_footprint(g, at.index, ivory_tricubic);
    int wide_count = enough || !ivory_grid_has_planes(g) ? 0 : 64;
    if (IVORY_GRID_LEVELS != 1) wide.z *= ivory_stored_factor(g, guard, wide, wide_count);
    IvoryPassed wide_passed = ivory_passed_by_guard(g, trust, guard, at, wide, wide_count);
    wide_seen = ivory_yield_wide(g, trust, guard, wide, wide_count, wide_passed, near, near_seen);
    if (wide_count > 0 && wide_seen.kept >= ivory_grid_least_weight) {
      float share = empty ? 0.0 : near_seen.kept / ivory_grid_enough_weight;
      near_factor *= share;
      wide_factor = (1.0 - share) / wide_seen.kept;
      rounds = near_count + 64;
    }
  }

  for (int round = 0; round < rounds; ++round) {
    bool is_near = round < near_count;
    int e = is_near ? round : round - near_count;
    ivec3 vertex, wide_vertex;
    float weight, wide_weight;
    ivory_footprint_entry(g, near, is_near ? e : 0, vertex, weight);
    ivory_footprint_entry(g, wide, e, wide_vertex, wide_weight);
    if (is_near) {
      weight = ivory_sees(near_seen, e) ? weight * near_factor : 0.0;
    } else {
      vertex = wide_vertex;
      weight = ivory_sees(wide_seen, e) ? wide_weight * wide_factor : 0.0;
    }
    ivec3 texel = ivory_grid_texel(g, guard, vertex);
    weight = texel.x < 0 ? 0.0 : weight;
    for (int f = 0; f < 12; ++f) {
      if (f < count) m[f] += weight * texelFetch(volumes, max(texel, ivec3(0)) + ivec3(g.slab[f]), 0).rgb;
    }
  }
  return !empty || wide_factor > 0.0;
}

// Where a world position that lies g.nudge_m before a surface, or in space where ng is 0, is looked up among levels.
IvoryLevelShares ivory_grid_shares(IvoryGrid g, usampler3D guard, vec3 p, vec3 ng, out vec3 corner, out vec3 nudge) {
  nudge = (ng * g.local_to_world) * (g.nudge_m / g.spacing_m);
  corner = ivory_grid_to_index(g, p) - nudge + 0.5;
  return ivory_level_shares(g, guard, corner, nudge);
}

// The level that counts most there, and the point's index coordinates in it.
IvoryGrid ivory_grid_level_at(IvoryGrid g, usampler3D guard, vec3 p, vec3 ng, out vec3 index, out float stored) {
  index = ivory_grid_to_index(g, p);
  stored = 1.0;
  if (IVORY_GRID_LEVELS == 1) return g;
  vec3 corner, nudge;
  IvoryLevelShares shares = ivory_grid_shares(g, guard, p, ng, corner, nudge);
  bool first = shares.share.x >= 0.5;
  int level = first ? shares.level.x : shares.level.y;
  stored = first ? shares.stored.x : shares.stored.y;
  index = corner * exp2(float(level)) - 0.5 + nudge;
  return ivory_grid_level(g, level);
}

// Of all levels by their shares; of two that meet one may see nothing, and the other answers alone.
void ivory_grid_of_levels(IvoryGrid g, sampler3D volumes, sampler3D trust, usampler3D guard, vec3 p, vec3 ng,
                          out vec3 m[12]) {
  vec3 corner, nudge;
  IvoryLevelShares shares = ivory_grid_shares(g, guard, p, ng, corner, nudge);
  for (int f = 0; f < 12; ++f) m[f] = vec3(0.0);
  float total = 0.0;
  int rounds = shares.share.y > 0.0 ? 2 : 1;
  for (int k = 0; k < rounds; ++k) {
    int level = k == 0 ? shares.level.x : shares.level.y;
    float share = k == 0 ? shares.share.x : shares.share.y;
    vec3 part[12];
    bool seen = ivory_grid_guarded(ivory_grid_level(g, level), volumes, trust, guard,
                                   corner * exp2(float(level)) - 0.5 + nudge, ng,
                                   k == 0 ? shares.stored.x : shares.stored.y, part);
    share = seen ? share : 0.0;
    total += share;
    for (int f = 0; f < 12; ++f) m[f] += share * part[f];
  }
  for (int f = 0; f < 12; ++f) m[f] *= total > 0.0 ? 1.0 / total : 0.0;
}

// Stored values to moments in lux, to be read at the unit normal n (world).
void ivory_grid_decode(IvoryGrid g, vec3 n, inout vec3 m[12]) {
  if (IVORY_GRID_FORM == ivory_grid_norms_and_directions) ivory_moments_from_compact(m, n * g.local_to_world);
  for (int f = 0; f < 12; ++f) m[f] *= g.scale;
}

// Moments in lux at the world position p, which is not nudged, to be read at the unit normal n. ng is the unit geometric
// normal of the surface that p lies g.nudge_m before, 0 for none.
void ivory_lookup_moments(IvoryGrid g, sampler3D volumes, sampler3D trust, usampler3D guard, vec3 p, vec3 ng, vec3 n,
                          out vec3 m[12]) {
  vec3 index = ivory_grid_to_index(g, p);
  if (IVORY_GRID_LEVELS != 1)
    ivory_grid_of_levels(g, volumes, trust, guard, p, ng, m);
  else if (IVORY_GRID_GUARD == ivory_guard_planes)
    ivory_grid_guarded(g, volumes, trust, guard, index, ng, 1.0, m);
  else
    ivory_grid_unguarded(g, volumes, trust, index, m);
  ivory_grid_decode(g, n, m);
}

// What the vertex of a texel stores: moments in lux to be read at the unit normal n, zero where it stores nothing.
void ivory_vertex_moments(IvoryGrid g, sampler3D volumes, sampler3D trust, ivec3 vertex, vec3 n, out vec3 m[12]) {
  float t = texelFetch(trust, vertex, 0).r;
  int count = ivory_grid_volume_count(g);
  for (int f = 0; f < 12; ++f) {
    m[f] = f < count && t > 0.0 ? texelFetch(volumes, vertex + ivec3(g.slab[f]), 0).rgb / t : vec3(0.0);
  }
  ivory_grid_decode(g, n, m);
}

// The same two without a normal or a surface in mind, as pictures of what is stored want them.
void ivory_lookup_moments(IvoryGrid g, sampler3D volumes, sampler3D trust, usampler3D guard, vec3 p, out vec3 m[12]) {
  ivory_lookup_moments(g, volumes, trust, guard, p, vec3(0.0), g.local_to_world * vec3(0.57735027), m);
}
void ivory_vertex_moments(IvoryGrid g, sampler3D volumes, sampler3D trust, ivec3 vertex, out vec3 m[12]) {
  ivory_vertex_moments(g, volumes, trust, vertex, g.local_to_world * vec3(0.57735027), m);
}

// E(n) from moments of this grid.
vec3 ivory_grid_irradiance(IvoryGrid g, vec3 m[12], vec3 n) {
  return ivory_irradiance(IVORY_GRID_BASIS, IVORY_GRID_RECONSTRUCTION, m, n * g.local_to_world);
}

// E(n) at surface point p.
vec3 ivory_lookup_irradiance(IvoryGrid g, sampler3D volumes, sampler3D trust, usampler3D guard, vec3 p, vec3 ng,
                             vec3 n) {
  vec3 m[12];
  ivory_lookup_moments(g, volumes, trust, guard, p + ng * g.nudge_m, ng, n, m);
  return ivory_grid_irradiance(g, m, n);
}
