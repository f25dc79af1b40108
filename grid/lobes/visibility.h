// How spheres hide a spherical light: a mask over the light's cap, and the mask's quad-tree, whose leaves are cosine
// lobes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "grid/base/names.h"
#include "grid/lobes/lobe.h"
#include "grid/lobes/sphere_set.h"

namespace ivory {

inline constexpr int max_mask_depth = 5;
inline constexpr int max_mask_size = 1 << max_mask_depth;

// A light seen from a point: a cap, and a frame around its axis z.
struct LightCap {
  V3f x, y, z;         // orthonormal
  float height = 0;    // 1 - cos of the half-angle; under 1
  float tan_half = 0;  // tan of half the half-angle
};
// `light` must not hold p.
LightCap make_light_cap(const Sphere& light, const V3f& p);

// The directions that it fills, as seen from p.
inline Cone make_cone(const LightCap& cap, const V3f& p) {
  return {p, cap.z, 1 - cap.height, std::sqrt(cap.height * (2 - cap.height))};
}

// Solid angle in sr.
inline float solid_angle(const LightCap& cap) { return 2 * pi * cap.height; }

// What of a cell of the mask must lie behind a sphere for the cell to be dark.
enum class MaskRule {
  center,  // its centre: neither brightens nor darkens on average
  inside,  // all of it ("aggressive" in the report): too bright
  touched  // any of it ("conservative"): too dark
};
template <>
inline constexpr auto name_table<MaskRule> = make_name_table<MaskRule>("mask", {{MaskRule::center, "center"},
                                                                                {MaskRule::inside, "inside"},
                                                                                {MaskRule::touched, "touched"}});

// A block of the square: its part of the disc. Solid angle over 2 pi is 4 t2 area/((1 + t2 a)(1 + t2 b))/(2 pi) and 1 -
// mean cosine to the centroid's direction 2 t2 variance/((1 + t2 a)(1 + t2 b)), t2 = tan_half^2.
struct MaskBlock {
  float x = 0;  // centroid
  float y = 0;
  float area = 0;  // 0: the block lies outside
  float a = 0;     // r^2 is as if uniform over [a, b]
  float b = 0;
  float variance = 0;  // mean squared distance from the centroid
};
// All blocks: level l has 4^l, row by row, from (4^l - 1)/3 on.
std::span<const MaskBlock> mask_blocks();

// 2^depth rows of 2^depth cells over the square around the cap; bit i of row j is the cell at x = (i + 1/2) 2/size - 1,
// y likewise, where the cap is the unit disc.
struct ShadowMask {
  int depth = 0;
  bool any = false;  // of the spheres reaches into the cap; otherwise rows are not set
  std::array<std::uint32_t, max_mask_size> rows;
};

// Splats the spheres that hide some of `light` from p: those nearer than it that do not hold p. depth from 0 to
// max_mask_depth.
ShadowMask make_shadow_mask(const Sphere& light, const LightCap& cap, const V3f& p, std::span<const Sphere> spheres,
                            int depth, MaskRule rule = MaskRule::center);

// A block of the quad-tree that is dark or lit throughout while its parent is neither, or is on the least level.
// spread_lobe(axis, height, spread) is the leaf's lobe. Without initial values: a shaded point's list of a thousand is
// not to be cleared first.
struct MaskLeaf {
  V3f axis;      // towards the centroid of the block's part of the cap
  float height;  // solid angle over 2 pi
  float spread;  // 1 - mean cosine to the axis; half the height for the whole light
  int level;     // 0 is the whole square
  bool lit;
};

// All leaves, in a fixed order; their solid angles add up to the cap's. Blocks above `least_level` (0 to
// max_mask_depth) are split, dark and lit ones alike. Returns how many leaves; max_mask_leaves at most, and `leaves`
// must hold so many.
int mask_leaves(const ShadowMask& mask, const LightCap& cap, std::span<MaskLeaf> leaves, int least_level = 0);
inline constexpr int max_mask_leaves = max_mask_size * max_mask_size;

}  // namespace ivory
