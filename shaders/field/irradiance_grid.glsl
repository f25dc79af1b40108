// E(p, n) from a baked irradiance grid. Twin of grid/field/irradiance_grid.cpp and grid/field/lookup.cpp;
// runtime/assets/irradiance_grid.h makes the textures and sets the numbers.
//
// Inputs, passed as parameters:
//   IvoryGrid g              the numbers; see the struct
//   sampler3D volumes        RGB16F, linear: one volume a function of the basis, side by side, each vertex's values
//                            times its trust, divided by g.scale
//   sampler3D trust          R16F, linear: min(1, visible fraction / 0.25) a vertex, 0 where nothing is stored
//   usampler3D guard         RGBA32UI, nearest: the vertex's guard record, whose order tells whether it is lit
//   vec3 p, ng, n            world position in metres, unit geometric normal on the lit side (0 for a point that lies
//                            before no surface), unit shading normal
// Answers are lux. p may lie anywhere; outside the grid its nearest vertices answer. With guard, what no vertex sees is
// dark.
//
// The choices among g (basis, form, guard, interpolation, reconstruction) may be compiled in instead of read from the
// struct, which saves what a driver makes of branches not taken: #define IVORY_GRID_BASIS and so on before this file
// (runtime/assets/irradiance_grid.h: grid_defines()).
#include "field/basis.glsl"
#include "field/guard.glsl"

#ifndef IVORY_GRID_BASIS
#define IVORY_GRID_BASIS g.basis
#endif
#ifndef IVORY_GRID_FORM
#define IVORY_GRID_FORM g.form
#endif
#ifndef IVORY_GRID_GUARD
#define IVORY_GRID_GUARD g.guard
#endif
#ifndef IVORY_GRID_INTERPOLATION
#define IVORY_GRID_INTERPOLATION g.interpolation
#endif
#ifndef IVORY_GRID_RECONSTRUCTION
#define IVORY_GRID_RECONSTRUCTION g.reconstruction
#endif
const int ivory_grid_moments = 0;  // the values of enum class GridForm
const int ivory_grid_norms_and_directions = 1;
const int ivory_trilinear = 0;  // of Interpolation
const int ivory_tricubic = 1;
const int ivory_guard_off = 0;  // of Guard
const int ivory_guard_planes = 1;

struct IvoryGrid {
  vec3 origin_m;         // world position of vertex (0,0,0)
  vec3 spacing_m;        // along the grid's own axes
  mat3 local_to_world;   // rotation: world = local_to_world * local
  ivec3 size;            // vertices
  vec3 slab[12];         // first texel of each volume
  vec3 texel;            // 1 / size of the volumes' texture
  float scale;           // lux a stored unit
  float nudge_m;         // how far p moves along ng first
  int basis;
  int form;
  int guard;
  int interpolation;
  int reconstruction;
};

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
  return textureLod(trust, (index + 0.5) / vec3(g.size), 0.0).r;
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
    vec3 at = clamp(index, vec3(0.0), last);
    kept = ivory_grid_filtered_trust(g, trust, at);
    for (int f = 0; f < 12; ++f) {
      if (f < count) m[f] = ivory_grid_filtered(g, volumes, f, at);
    }
    return;
  }
  IvoryFootprint footprint = ivory_make_footprint(g, index, ivory_tricubic);
  vec3 w1 = vec3(footprint.x.y, footprint.y.y, footprint.z.y);
  vec3 w3 = vec3(footprint.x.w, footprint.y.w, footprint.z.w);
  vec3 low = vec3(footprint.x.x, footprint.y.x, footprint.z.x) + w1;
  vec3 high = vec3(footprint.x.z, footprint.y.z, footprint.z.z) + w3;
  vec3 from = clamp(vec3(footprint.first) + w1 / low, vec3(0.0), last);
  vec3 to = clamp(vec3(footprint.first) + 2.0 + w3 / high, vec3(0.0), last);
  kept = 0.0;
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
    weight *= texelFetch(trust, vertex, 0).r;
    vec3 u = index - vec3(vertex);
    bool behind = dot(facing, u) > behind_m;
    bool in_front = at_surface && !behind;
    uvec4 record = texelFetch(guard, vertex, 0);
    bool visible = weight > 0.0 && !(footprint.wide && behind) && ivory_hidden_by(record, u) <= 0.0;
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
  mat4 planes = ivory_unpacked_guard(texelFetch(guard, from, 0));
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
IvoryPassed ivory_without(IvoryGrid g, sampler3D trust, IvoryFootprint footprint, IvoryPassed passed, uvec2 hidden,
                          int count) {
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
    weight *= texelFetch(trust, vertex, 0).r;
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
  IvoryPassed left = ivory_without(g, trust, footprint, passed, hidden, yields ? 8 : 0);
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
    weight *= texelFetch(trust, vertex, 0).r;
    bool heard = ivory_sees(near_seen, k) && weight >= ivory_grid_least_weight * near_seen.kept;
    hidden |= ivory_hidden_from(g, guard, near, k, footprint, heard ? count : 0);
  }
  bool alone = !witnessed && passed.witness >= 0;
  hidden |= ivory_hidden_from(g, guard, footprint, passed.witness, footprint, alone ? count : 0);
  return ivory_seen(ivory_without(g, trust, footprint, passed, hidden, count));
}

// As guarded_footprint(): the values of the vertices that see the point. Most points are seen by all of theirs, whose
// weights are then the filter's. The others take a loop over vertices, one fetch a volume each, which costs no more
// than fetching pairs of neighbours of arbitrary weights as one linear fetch between them: that filters eight texels
// for two.
//
// `rounds` is 0 where a point needs none: drivers that turn branches into masks skip the rounds of a loop that no pixel
// of a group needs, but run both sides of a branch.
void ivory_grid_guarded(IvoryGrid g, sampler3D volumes, sampler3D trust, usampler3D guard, vec3 index, vec3 ng,
                        out vec3 m[12]) {
  int count = ivory_grid_volume_count(g);
  IvoryFootprint near = ivory_make_footprint(g, index, IVORY_GRID_INTERPOLATION);
  int near_count = ivory_footprint_count(near);
  IvoryPassed near_passed = ivory_passed_by_guard(g, trust, guard, index, ng, near, near_count);
  IvorySeen near_seen = IvorySeen(uvec2(0u), 0.0, true);
  if (IVORY_GRID_INTERPOLATION == ivory_trilinear) {
    near_seen = ivory_yield_near(g, trust, guard, near, near_passed);
  } else {
    IvoryFootprint eight = ivory_make_footprint(g, index, ivory_trilinear);
    IvoryPassed passed = ivory_passed_by_guard(g, trust, guard, index, ng, eight, 8);
    IvorySeen witnesses = ivory_yield_near(g, trust, guard, eight, passed);
    near_seen = ivory_yield_wide(g, trust, guard, near, 64, near_passed, eight, witnesses);
  }
  bool enough = near_seen.kept >= ivory_grid_enough_weight;
  bool filtered = near_seen.all && enough;
  // Divided by the trust that the same filter finds: hardware rounds its weights, to the same for both.
  float filtered_kept;
  ivory_grid_filter(g, volumes, trust, index, m, filtered_kept);
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
    int wide_count = enough ? 0 : 64;
    IvoryPassed wide_passed = ivory_passed_by_guard(g, trust, guard, index, ng, wide, wide_count);
    wide_seen = ivory_yield_wide(g, trust, guard, wide, wide_count, wide_passed, near, near_seen);
    if (!enough && wide_seen.kept >= ivory_grid_least_weight) {
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
    for (int f = 0; f < 12; ++f) {
      if (f < count) m[f] += weight * texelFetch(volumes, vertex + ivec3(g.slab[f]), 0).rgb;
    }
  }
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
  if (IVORY_GRID_GUARD == ivory_guard_planes)
    ivory_grid_guarded(g, volumes, trust, guard, index, ng, m);
  else
    ivory_grid_unguarded(g, volumes, trust, index, m);
  ivory_grid_decode(g, n, m);
}

// What one vertex stores: moments in lux to be read at the unit normal n, zero where it stores nothing.
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
