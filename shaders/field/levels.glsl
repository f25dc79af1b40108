// Grids of several spacings: where a vertex's texel lies, and how much a look-up reads of each level. Twin of
// grid/field/lattice.h and of level_shares() in grid/field/irradiance_grid.cpp.
//
// All levels' vertices stand in bricks of 4 x 4 x 4 texels of one atlas, in which the brick of number `slot` is (slot %
// 2^x, slot / 2^x % 2^y, slot / 2^(x + y)), x, y and x + y being g.atlas_bits. Behind the guard records, from slice
// g.table_slice on, the guard's texture holds a table a level, four entries a texel: a brick's slot, or ivory_no_brick.
//
// Level l of g describes that level alone: g.origin_m, g.spacing_m, g.size, g.nudge_m, g.bricks and g.table are its own.
#include "field/grid.glsl"

const uint ivory_no_brick = 0xffffffffu;

IvoryGrid ivory_grid_level(IvoryGrid g, int level) {
  IvoryGrid l = g;
  float fine = exp2(float(level));
  l.size = g.size << level;
  l.spacing_m = g.spacing_m / fine;
  l.origin_m = g.origin_m - g.local_to_world * ((g.spacing_m - l.spacing_m) * 0.5);
  l.nudge_m = g.nudge_m / fine;
  l.bricks = (l.size + 3) >> 2;
  l.table = g.tables[level];
  return l;
}

// Texel of a vertex of level g within its size; x is -1 where it is not stored. In a grid of one level each vertex is
// stored, in the texel of its own coordinates.
ivec3 ivory_grid_texel(IvoryGrid g, usampler3D guard, ivec3 vertex) {
  if (IVORY_GRID_LEVELS == 1) return vertex;
  ivec3 brick = vertex >> 2;
  int entry = g.table + (brick.z * g.bricks.y + brick.y) * g.bricks.x + brick.x;
  int texel = entry >> 2;
  ivec3 bits = g.atlas_bits + ivec3(2, 2, 4);  // of texels
  ivec3 mask = (ivec3(1) << bits) - 1;
  uvec4 entries = texelFetch(
      guard, ivec3(texel & mask.x, (texel >> bits.x) & mask.y, g.table_slice + (texel >> bits.z)), 0);
  uvec2 two = (entry & 2) != 0 ? entries.zw : entries.xy;
  uint slot = (entry & 1) != 0 ? two.y : two.x;
  mask = (ivec3(1) << g.atlas_bits) - 1;
  ivec3 first =
      ivec3(int(slot) & mask.x, (int(slot) >> g.atlas_bits.x) & mask.y, int(slot) >> g.atlas_bits.z);
  return slot == ivory_no_brick ? ivec3(-1, 0, 0) : (first << 2) + (vertex & 3);
}
float ivory_texel_trust(sampler3D trust, ivec3 texel) {
  return texel.x < 0 ? 0.0 : texelFetch(trust, max(texel, ivec3(0)), 0).r;
}

// The trilinear weight of those of the eight vertices around the point that level g stores.
float ivory_grid_stored_weight(IvoryGrid g, usampler3D guard, vec3 index) {
  vec3 clamped = clamp(index, vec3(0.0), vec3(g.size - 1));
  ivec3 base = min(ivec3(clamped), g.size - 2);
  vec3 t = clamped - vec3(base);
  bool first = ivory_grid_texel(g, guard, base).x >= 0;
  bool in_one_brick = all(notEqual(base & 3, ivec3(3)));
  float stored = 0.0;
  bool whole = true;
  int rounds = in_one_brick ? 0 : 8;
  for (int e = 0; e < rounds; ++e) {
    ivec3 side = ivec3(e & 1, (e >> 1) & 1, e >> 2);
    vec3 w = mix(1.0 - t, t, vec3(side));
    bool is_there = ivory_grid_texel(g, guard, base + side).x >= 0;
    stored += is_there ? w.z * w.y * w.x : 0.0;
    whole = whole && is_there;
  }
  return in_one_brick ? (first ? 1.0 : 0.0) : whole ? 1.0 : stored;
}

struct IvoryLevelShares {
  ivec2 level;
  vec2 share;   // 1 in all
  vec2 stored;  // of each level's eight vertices, their weight
};
// corner: the surface point in voxels of the coarsest level from the box's corner; nudge: how far it is moved off the
// surface, in voxels of each level.
IvoryLevelShares ivory_level_shares(IvoryGrid g, usampler3D guard, vec3 corner, vec3 nudge) {
  IvoryLevelShares shares = IvoryLevelShares(ivec2(0), vec2(1.0, 0.0), vec2(1.0));
  bool is_open = true;  // nothing is stored in a finer level
  bool done = false;
  for (int level = g.levels - 1; level > 0 && !done; --level) {
    float stored =
        ivory_grid_stored_weight(ivory_grid_level(g, level), guard, corner * exp2(float(level)) - 0.5 + nudge);
    if (stored > 0.0 && is_open) {
      shares = IvoryLevelShares(ivec2(level, 0), vec2(stored, 1.0 - stored), vec2(stored, 1.0));
      is_open = false;
      done = stored >= 1.0;
    } else if (stored > 0.0) {
      shares.level.y = level;
      shares.stored.y = stored;
      done = true;
    }
  }
  return shares;
}
