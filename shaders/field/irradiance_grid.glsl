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
#include "field/guard.glsl"
#include "field/levels.glsl"

// Weights below are rounding noise once renormalised.
const float ivory_grid_least_weight = 1e-4;
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

// The vertices that one axis contributes, from `first` on, and their weights: two or four.
void ivory_axis_footprint(float x, int size, int interpolation, out int first, out vec4 weight) {
  float clamped = clamp(x, 0.0, float(size - 1));
  int base = min(int(clamped), size - 2);
  float t = clamped - float(base);
  float s = 1.0 - t;
  if (interpolation == ivory_trilinear) {
    first = base;
    weight = vec4(s, t, 0.0, 0.0);
  } else {
    first = base - 1;
    weight = vec4(s * s * s, 4.0 - 6.0 * t * t + 3.0 * t * t * t, 4.0 - 6.0 * s * s + 3.0 * s * s * s, t * t * t) / 6.0;
  }
}

// The vertices that a look-up reads: entry e is vertex first + (e % width, e / width % width, e / width^2), beyond the
// border the outermost one instead.
struct IvoryFootprint {
  ivec3 first;
  vec4 x;  // weights along the axes
  vec4 y;
  vec4 z;
  bool wide;  // 64 entries, else 8
};
IvoryFootprint ivory_make_footprint(IvoryGrid g, vec3 index, int interpolation) {
  IvoryFootprint footprint;
  ivory_axis_footprint(index.x, g.size.x, interpolation, footprint.first.x, footprint.x);
  ivory_axis_footprint(index.y, g.size.y, interpolation, footprint.first.y, footprint.y);
  ivory_axis_footprint(index.z, g.size.z, interpolation, footprint.first.z, footprint.z);
  footprint.wide = interpolation == ivory_tricubic;
  return footprint;
}
int ivory_footprint_count(IvoryFootprint footprint) { return footprint.wide ? 64 : 8; }

void ivory_footprint_entry(IvoryGrid g, IvoryFootprint footprint, int e, out ivec3 vertex, out float weight) {
  ivec3 at = footprint.wide ? ivec3(e & 3, (e >> 2) & 3, e >> 4) : ivec3(e & 1, (e >> 1) & 1, e >> 2);
  vertex = clamp(footprint.first + at, ivec3(0), g.size - 1);
  weight = footprint.z[at.z] * footprint.y[at.y] * footprint.x[at.x];
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

// Sets of up to 64 entries.
uvec2 ivory_entry_bit(int e) { return uvec2(e < 32 ? 1u << uint(e) : 0u, e < 32 ? 0u : 1u << uint(e - 32)); }

// What the guard leaves of a footprint.
struct IvorySeen {
  uvec2 entries;  // that see the point
  float kept;     // their trusted weight
  bool all;       // no entry that stores something is hidden
};
bool ivory_sees(IvorySeen seen, int e) {
  return (((e < 32 ? seen.entries.x : seen.entries.y) >> uint(e & 31)) & 1u) != 0u;
}

// What the planes let through, before any gives way (grid/field/yield.h).
struct IvoryPassed {
  uvec2 entries;
  uvec2 lit;        // those of them whose vertices are lit
  uvec2 in_front;   // all entries whose vertices stand before the surface,
  uvec2 stored;     // and all that store something
  float kept;       // trusted weights of `entries` and `lit`
  float kept_lit;
  bool yield;       // a lit entry is in front: the unlit give way
  int witness;      // the heaviest entry in front, and the heaviest that is lit as well; -1: none
  int lit_witness;
};

// Grids of one level that are read without guard take another way; of several levels, all vertices are let through.
bool ivory_grid_has_planes(IvoryGrid g) { return IVORY_GRID_LEVELS == 1 || IVORY_GRID_GUARD == ivory_guard_planes; }

// Planes are fitted within a voxel of their vertex: a wide footprint's vertices do not count behind the surface, which
// has the unit normal ng and lies g.nudge_m behind the point. A hundredth of a voxel keeps those in its very plane.
IvoryPassed ivory_passed_by_guard(IvoryGrid g, sampler3D trust, usampler3D guard, vec3 index, vec3 ng,
                                  IvoryFootprint footprint, int count) {
  IvoryPassed passed = IvoryPassed(uvec2(0u), uvec2(0u), uvec2(0u), uvec2(0u), 0.0, 0.0, false, -1, -1);
  vec3 facing = ng * g.local_to_world * g.spacing_m;
  float behind_m = g.nudge_m + 0.01 * min(g.spacing_m.x, min(g.spacing_m.y, g.spacing_m.z));
  bool at_surface = ng != vec3(0.0);
  vec2 most = vec2(ivory_grid_least_weight);
  for (int e = 0; e < count; ++e) {
    ivec3 vertex;
    float weight;
    ivory_footprint_entry(g, footprint, e, vertex, weight);
    ivec3 texel = ivory_grid_texel(g, guard, vertex);
    weight *= ivory_texel_trust(trust, texel);
    vec3 u = index - vec3(vertex);
    bool behind = dot(facing, u) > behind_m;
    bool in_front = at_surface && !behind && ivory_grid_has_planes(g);
    uvec4 record = uvec4(0u);
    if (ivory_grid_has_planes(g)) record = texelFetch(guard, max(texel, ivec3(0)), 0);
    bool visible = weight > 0.0 && ivory_hidden_by(record, u) <= 0.0;
    visible = visible && !(footprint.wide && behind && ivory_grid_has_planes(g));
    bool lit = visible && ivory_guard_lit(record);
    uvec2 bit = ivory_entry_bit(e);
    passed.entries |= visible ? bit : uvec2(0u);
    passed.lit |= lit ? bit : uvec2(0u);
    passed.in_front |= in_front ? bit : uvec2(0u);
    passed.stored |= weight > 0.0 ? bit : uvec2(0u);
    passed.kept += visible ? weight : 0.0;
    passed.kept_lit += lit ? weight : 0.0;
    passed.yield = passed.yield || (lit && in_front && weight >= ivory_grid_least_weight);
    bool heaviest = visible && in_front && weight > most.x;
    bool heaviest_lit = lit && in_front && weight > most.y;
    passed.witness = heaviest ? e : passed.witness;
    passed.lit_witness = heaviest_lit ? e : passed.lit_witness;
    most = vec2(heaviest ? weight : most.x, heaviest_lit ? weight : most.y);
  }
  return passed;
}

// Entries of the footprint that the witness, an entry of `near`, does not see by its planes.
uvec2 ivory_hidden_from(IvoryGrid g, usampler3D guard, IvoryFootprint near, int witness, IvoryFootprint footprint,
                        int count) {
  ivec3 from, vertex;
  float weight;
  ivory_footprint_entry(g, near, max(witness, 0), from, weight);
  mat4 planes = ivory_unpacked_guard(texelFetch(guard, max(ivory_grid_texel(g, guard, from), ivec3(0)), 0));
  uvec2 hidden = uvec2(0u);
  for (int e = 0; e < count; ++e) {
    ivory_footprint_entry(g, footprint, e, vertex, weight);
    vec4 beyond = vec4(vec3(vertex - from), -1.0) * planes;
    bool hides = max(max(beyond.x, beyond.y), max(beyond.z, beyond.w)) > 0.0;
    hidden |= hides ? ivory_entry_bit(e) : uvec2(0u);
  }
  return hidden;
}

// The sums of what is left of `passed` once `hidden` are gone.
IvoryPassed ivory_without(IvoryGrid g, sampler3D trust, usampler3D guard, IvoryFootprint footprint, IvoryPassed passed,
                          uvec2 hidden, int count) {
  IvoryPassed left = passed;
  left.entries &= ~hidden;
  left.lit &= ~hidden;
  left.kept = 0.0;
  left.kept_lit = 0.0;
  left.yield = false;
  for (int e = 0; e < count; ++e) {
    ivec3 vertex;
    float weight;
    ivory_footprint_entry(g, footprint, e, vertex, weight);
    weight *= ivory_texel_trust(trust, ivory_grid_texel(g, guard, vertex));
    uvec2 bit = ivory_entry_bit(e);
    bool lit = (left.lit & bit) != uvec2(0u);
    left.kept += (left.entries & bit) != uvec2(0u) ? weight : 0.0;
    left.kept_lit += lit ? weight : 0.0;
    left.yield = left.yield || (lit && (left.in_front & bit) != uvec2(0u) && weight >= ivory_grid_least_weight);
  }
  return left;
}
IvorySeen ivory_seen(IvoryPassed passed) {
  uvec2 entries = passed.yield ? passed.lit : passed.entries;
  return IvorySeen(entries, passed.yield ? passed.kept_lit : passed.kept, (entries & passed.stored) == passed.stored);
}

// As yield_near(). Most points have no vertex that is in doubt, and take no round of the loops.
IvorySeen ivory_yield_near(IvoryGrid g, sampler3D trust, usampler3D guard, IvoryFootprint footprint,
                           IvoryPassed passed) {
  IvorySeen seen = ivory_seen(passed);
  int witness = passed.yield ? passed.lit_witness : passed.witness;
  uvec2 doubtful = seen.entries & ~passed.in_front;
  bool ask = witness >= 0 && doubtful != uvec2(0u);
  uvec2 hidden = doubtful & ivory_hidden_from(g, guard, footprint, witness, footprint, ask ? 8 : 0);
  bool yields = hidden != uvec2(0u);
  IvoryPassed left = ivory_without(g, trust, guard, footprint, passed, hidden, yields ? 8 : 0);
  left.yield = passed.yield;  // what gives way to the witness is not in front
  if (yields) return ivory_seen(left);
  return seen;
}

// As yield_wide(). Entries of near_seen are the witnesses, where it has any; `count` is 0 where the footprint is not
// asked.
IvorySeen ivory_yield_wide(IvoryGrid g, sampler3D trust, usampler3D guard, IvoryFootprint footprint, int count,
                           IvoryPassed passed, IvoryFootprint near, IvorySeen near_seen) {
  uvec2 hidden = uvec2(0u);
  bool witnessed = near_seen.kept >= ivory_grid_least_weight;
  int rounds = witnessed && count > 0 ? 8 : 0;
  for (int k = 0; k < rounds; ++k) {
    ivec3 vertex;
    float weight;
    ivory_footprint_entry(g, near, k, vertex, weight);
    weight *= ivory_texel_trust(trust, ivory_grid_texel(g, guard, vertex));
    bool heard = ivory_sees(near_seen, k) && weight >= ivory_grid_least_weight * near_seen.kept;
    hidden |= ivory_hidden_from(g, guard, near, k, footprint, heard ? count : 0);
  }
  bool alone = !witnessed && passed.witness >= 0;
  hidden |= ivory_hidden_from(g, guard, footprint, passed.witness, footprint, alone ? count : 0);
  return ivory_seen(ivory_without(g, trust, guard, footprint, passed, hidden, count));
}

// What the footprint's weights are to be multiplied by, so that those of stored vertices add up to one.
float ivory_stored_factor(IvoryGrid g, usampler3D guard, IvoryFootprint footprint, int count) {
  float stored = 0.0;
  bool whole = true;
  for (int e = 0; e < count; ++e) {
    ivec3 vertex;
    float weight;
    ivory_footprint_entry(g, footprint, e, vertex, weight);
    bool is_there = ivory_grid_texel(g, guard, vertex).x >= 0;
    stored += is_there ? weight : 0.0;
    whole = whole && is_there;
  }
  return whole || stored <= 0.0 ? 1.0 : 1.0 / stored;
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
  IvoryFootprint near = ivory_make_footprint(g, index, IVORY_GRID_INTERPOLATION);
  int near_count = ivory_footprint_count(near);
  bool can_filter = true;
  vec3 filter_index = index;
  if (IVORY_GRID_LEVELS != 1) {
    ivec3 texel = ivory_grid_texel(g, guard, clamp(near.first, ivec3(0), g.size - 1));
    can_filter = !near.wide && texel.x >= 0 && all(notEqual(near.first & 3, ivec3(3)));
    filter_index = vec3(max(texel, ivec3(0))) + vec3(near.x.y, near.y.y, near.z.y);
    near.z *= near.wide ? ivory_stored_factor(g, guard, near, 64) : 1.0 / stored;
  }
  IvoryPassed near_passed = ivory_passed_by_guard(g, trust, guard, index, ng, near, near_count);
  IvorySeen near_seen = IvorySeen(uvec2(0u), 0.0, true);
  if (IVORY_GRID_INTERPOLATION == ivory_trilinear) {
    near_seen = ivory_yield_near(g, trust, guard, near, near_passed);
  } else if (IVORY_GRID_GUARD != ivory_guard_planes) {
    near_seen = ivory_seen(near_passed);
  } else {
    IvoryFootprint eight = ivory_make_footprint(g, index, ivory_trilinear);
    IvoryPassed passed = ivory_passed_by_guard(g, trust, guard, index, ng, eight, 8);
    IvorySeen witnesses = ivory_yield_near(g, trust, guard, eight, passed);
    near_seen = ivory_yield_wide(g, trust, guard, near, 64, near_passed, eight, witnesses);
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
    wide = ivory_make_footprint(g, index, ivory_tricubic);
    int wide_count = enough || !ivory_grid_has_planes(g) ? 0 : 64;
    if (IVORY_GRID_LEVELS != 1) wide.z *= ivory_stored_factor(g, guard, wide, wide_count);
    IvoryPassed wide_passed = ivory_passed_by_guard(g, trust, guard, index, ng, wide, wide_count);
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
