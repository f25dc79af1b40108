// Which vertices of a footprint see a point, by their guard's planes, and which of those give way to others. Twin of
// visible_by_guard() in grid/field/guard.cpp and of grid/field/yield.cpp, where the reasons are.
//
// Inputs, passed as parameters:
//   IvoryGrid g              the numbers, of one level: field/grid.glsl
//   sampler3D trust          min(1, visible fraction / 0.25) a vertex, 0 where nothing is stored
//   usampler3D guard         the vertices' guard records, whose order tells whether they are lit: field/guard.glsl
//   IvoryNudged at           the point, in that level
//   IvoryFootprint footprint the vertices asked: field/footprint.glsl; `count` of them: 8 or 64, 0 for none
// Entries are bits of uvec2, entry e being bit e % 32 of word e / 32.
#include "field/footprint.glsl"
#include "field/guard.glsl"

// Weights below are rounding noise once renormalised.
const float ivory_grid_least_weight = 1e-4;

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
  uvec2 closer;     // of those with a weight that counts: the vertex sees the closer point too,
  uvec2 apart;      // or does not
  float kept;       // trusted weights of `entries` and `lit`
  float kept_lit;
  bool yield;       // a lit entry is in front: the unlit give way
  int witness;      // the heaviest entry in front, and the heaviest that is lit as well; -1: none
  int lit_witness;
};

// A point of a level to be looked up.
struct IvoryNudged {
  vec3 index;   // its index coordinates
  vec3 ng;      // unit normal (world) of the surface that it lies before, 0 for none,
  float off_m;  // and how far before it
};

// As closer_point().
const float ivory_grid_closer_share = 0.1875;
IvoryNudged ivory_closer(IvoryGrid g, IvoryNudged at) {
  float off_m = at.off_m * ivory_grid_closer_share;
  return IvoryNudged(at.index - (at.ng * g.local_to_world) * ((at.off_m - off_m) / g.spacing_m), at.ng, off_m);
}

// Grids of one level that are read without guard take another way; of several levels, all vertices are let through.
bool ivory_grid_has_planes(IvoryGrid g) { return IVORY_GRID_LEVELS == 1 || IVORY_GRID_GUARD == ivory_guard_planes; }

// Planes are fitted within a voxel of their vertex: a wide footprint's vertices do not count behind the surface. A
// hundredth of a voxel keeps those in its very plane.
IvoryPassed ivory_passed_by_guard(IvoryGrid g, sampler3D trust, usampler3D guard, IvoryNudged at,
                                  IvoryFootprint footprint, int count) {
  IvoryPassed passed =
      IvoryPassed(uvec2(0u), uvec2(0u), uvec2(0u), uvec2(0u), uvec2(0u), uvec2(0u), 0.0, 0.0, false, -1, -1);
  vec3 facing = at.ng * g.local_to_world * g.spacing_m;
  float behind_m = at.off_m + 0.01 * min(g.spacing_m.x, min(g.spacing_m.y, g.spacing_m.z));
  bool at_surface = at.ng != vec3(0.0);
  vec3 back = ivory_closer(g, at).index - at.index;
  vec2 most = vec2(ivory_grid_least_weight);
  for (int e = 0; e < count; ++e) {
    ivec3 vertex;
    float weight;
    ivory_footprint_entry(g, footprint, e, vertex, weight);
    ivec3 texel = ivory_grid_texel(g, guard, vertex);
    weight *= ivory_texel_trust(trust, texel);
    vec3 u = at.index - vec3(vertex);
    bool behind = dot(facing, u) > behind_m;
    bool in_front = at_surface && !behind && ivory_grid_has_planes(g);
    uvec4 record = uvec4(0u);
    if (ivory_grid_has_planes(g)) record = texelFetch(guard, max(texel, ivec3(0)), 0);
    mat4 planes = ivory_unpacked_guard(record);
    bool visible = weight > 0.0 && ivory_hidden_by(planes, u) <= 0.0;
    bool sees_closer = ivory_hidden_by(planes, u + back) <= 0.0;
    visible = visible && !(footprint.wide && behind && ivory_grid_has_planes(g));
    bool lit = visible && ivory_guard_lit(record);
    uvec2 bit = ivory_entry_bit(e);
    passed.entries |= visible ? bit : uvec2(0u);
    passed.lit |= lit ? bit : uvec2(0u);
    passed.in_front |= in_front ? bit : uvec2(0u);
    passed.stored |= weight > 0.0 ? bit : uvec2(0u);
    bool counts = visible && weight >= ivory_grid_least_weight;
    passed.closer |= counts && sees_closer ? bit : uvec2(0u);
    passed.apart |= counts && !sees_closer ? bit : uvec2(0u);
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
    hidden |= ivory_hidden_by(planes, vec3(vertex - from)) > 0.0 ? ivory_entry_bit(e) : uvec2(0u);
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

// As see_too() in grid/field/lookup.cpp: do those that were read see the closer point?
bool ivory_see_closer(IvoryPassed passed, IvorySeen seen) {
  uvec2 closer = passed.closer & seen.entries;
  uvec2 apart = passed.apart & seen.entries;
  bool any_lit = (passed.lit & (closer | apart)) != uvec2(0u);
  return any_lit ? closer != uvec2(0u) : apart == uvec2(0u);
}
