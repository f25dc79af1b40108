// How spheres hide a spherical light: a mask of bits over the light's cap, and its quad-tree. Twin of
// grid/lobes/visibility.cpp, where the geometry is derived.
//
// Define before it, else the defaults hold:
//   IVORY_MASK_DEPTH  the mask has 2^depth rows of 2^depth cells, 0 to 5; bit i of row j is the cell at column i
//   IVORY_LEAF_DEPTH  the finest level that leaves may lie on, IVORY_MASK_DEPTH to 5: what lights are split to
//                     (lobes/light.glsl)
//
// Loops have constant bounds for compilers to unroll, so that rows are registers. The leaves are found by walking over
// the rows' bits; without branches that lanes would have to wait for.
#include "base/pi.glsl"
#include "lobes/lobe.glsl"
#include "lobes/sphere_set.glsl"

#ifndef IVORY_MASK_DEPTH
#define IVORY_MASK_DEPTH 4
#endif
#ifndef IVORY_LEAF_DEPTH
#if IVORY_MASK_DEPTH > 3
#define IVORY_LEAF_DEPTH IVORY_MASK_DEPTH
#else
#define IVORY_LEAF_DEPTH 3
#endif
#endif
#define IVORY_MASK_SIZE (1 << IVORY_MASK_DEPTH)
#define IVORY_LEAF_SIZE (1 << IVORY_LEAF_DEPTH)

// A light seen from a point: a cap, and a frame around its axis z.
struct IvoryLightCap {
  vec3 x, y, z;
  float height;    // 1 - cos of the half-angle; under 1
  float tan_half;  // tan of half the half-angle
};

// `light` must not hold p.
IvoryLightCap ivory_make_light_cap(vec4 light, vec3 p) {
  vec3 d = light.xyz - p;
  float dist = sqrt(dot(d, d));
  vec3 z = d / dist;
  float sign = z.z < 0.0 ? -1.0 : 1.0;
  float a = -1.0 / (sign + z.z);
  float b = z.x * z.y * a;
  float height = ivory_sphere_cap_height(light.w, dist);
  return IvoryLightCap(vec3(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x), vec3(b, sign + z.y * z.y * a, -z.y), z,
                       height, sqrt(height / (2.0 - height)));
}

// Marks the cells of `rows` whose centres (grown by `grow`: 0, or -+ sqrt(2)/2^depth for MaskRule inside and touched)
// lie behind the sphere, if `wanted`. A sphere that holds p, or is no nearer than the light, hides nothing.
void ivory_splat_sphere(inout uint rows[IVORY_MASK_SIZE], vec4 sphere, bool wanted, IvoryLightCap cap, vec3 p,
                        float light_power, float grow) {
  const float half_size = 0.5 * float(IVORY_MASK_SIZE);
  const uint all = IVORY_MASK_DEPTH == 5 ? ~0u : (1u << uint(IVORY_MASK_SIZE)) - 1u;
  vec3 d = sphere.xyz - p;
  float tangent2 = dot(d, d) - sphere.w * sphere.w;
  float z = dot(d, cap.z) + sqrt(max(tangent2, 0.0));
  bool inverted = z <= 0.0;  // the cap holds the direction opposite to the light
  float scale = (1.0 / cap.tan_half) / (z != 0.0 ? z : -1e-20);
  float cx = dot(d, cap.x) * scale;
  float cy = dot(d, cap.y) * scale;
  float radius = sphere.w * abs(scale) + (inverted ? -grow : grow);
  float off2 = cx * cx + cy * cy;
  bool reaches = inverted ? !(max(radius, 0.0) >= 1.0 && off2 <= (radius - 1.0) * (radius - 1.0))
                          : radius > 0.0 && off2 < (1.0 + radius) * (1.0 + radius);
  wanted = wanted && tangent2 > 0.0 && tangent2 < light_power && reaches;
  radius = max(radius, 0.0);
  float radius2 = radius * radius;
  float first = (cx + 1.0) * half_size - 0.5;
  uint keep = wanted ? all : 0u;
  uint flip = inverted ? ~0u : 0u;
  for (int j = 0; j < IVORY_MASK_SIZE; ++j) {
    float y = (float(j) + 0.5) / half_size - 1.0 - cy;
    float w2 = radius2 - y * y;
    float w = sqrt(max(w2, 0.0)) * half_size;
    // Cells whose centres lie within [first - w, first + w].
    float low = max(ceil(first - w), 0.0);
    float high = min(floor(first + w), 31.0);
    uint from = ~0u << uint(min(low, 31.0));
    uint to = ~0u >> (31u - uint(max(high, 0.0)));
    uint inside = low <= high && w2 > 0.0 ? from & to : 0u;
    rows[j] |= (inside ^ flip) & keep;
  }
}

// Cells at each end of a row that lie outside the disc altogether: those that grid/lobes/visibility.cpp finds no part
// in.
uint ivory_outside_row(int j) {
#if IVORY_LEAF_DEPTH == 5
  const int ends[16] = int[16](10, 8, 6, 5, 4, 3, 2, 2, 1, 1, 0, 0, 0, 0, 0, 0);
#elif IVORY_LEAF_DEPTH == 4
  const int ends[8] = int[8](4, 2, 1, 1, 0, 0, 0, 0);
#elif IVORY_LEAF_DEPTH == 3
  const int ends[4] = int[4](1, 0, 0, 0);
#else
  const int ends[1] = int[1](0);
  j = 0;
#endif
  int k = ends[min(j, IVORY_LEAF_SIZE - 1 - j)];
  uint end = (1u << uint(k)) - 1u;
  return end | (end << uint(IVORY_LEAF_SIZE - max(k, 1)));
}

// The leaves of a mask's quad-tree: blocks that are dark or lit throughout while their parents are neither. Each has a
// bit of its own in `anchor`, at its first cell in a grid of 2^IVORY_LEAF_DEPTH; there are its `lit` bit and the three
// bits of how many levels it lies above that grid.
struct IvoryMaskLeaves {
  uint anchor[IVORY_LEAF_SIZE];
  uint lit[IVORY_LEAF_SIZE];
  uint above0[IVORY_LEAF_SIZE];
  uint above1[IVORY_LEAF_SIZE];
  uint above2[IVORY_LEAF_SIZE];
  uint rows;  // bit j: row j has anchors
};

// One level: blocks of 2^S cells make those of 2^(S+1), and keep what these do not take. `dark`, `bright` and `outside`
// hold at a block's first cell whether it is so throughout.
#define IVORY_LEAVES_LEFT(S, row, taken) ((dark[row] | bright[row]) & ~outside[row] & ~(taken) & (S <= finest ? ~0u : 0u))
#define IVORY_MARK_LEAVES(row, own) leaves.anchor[row] |= own; leaves.lit[row] |= own & bright[row];
#define IVORY_MARK_BIT(S, above, bit, row, own) if ((S & bit) != 0) leaves.above[row] |= own;
#define IVORY_MARK_BITS_01(S, row, own) IVORY_MARK_BIT(S, above0, 1, row, own) IVORY_MARK_BIT(S, above1, 2, row, own)
#define IVORY_MARK_LEVEL(S, row, own) IVORY_MARK_BITS_01(S, row, own) IVORY_MARK_BIT(S, above2, 4, row, own)
#define IVORY_TAKE_OWN(S, row, own) IVORY_MARK_LEAVES(row, own) IVORY_MARK_LEVEL(S, row, own)
#define IVORY_TAKE_LEAVES(S, row, taken) { uint own = IVORY_LEAVES_LEFT(S, row, taken); IVORY_TAKE_OWN(S, row, own) }

#define IVORY_IN_BOTH(x, S, FIRST) (x[j] & x[k] & ((x[j] & x[k]) >> uint(1 << S)) & FIRST)
#define IVORY_MERGE_DARK(S, FIRST) uint d = IVORY_IN_BOTH(dark, S, FIRST); uint b = IVORY_IN_BOTH(bright, S, FIRST);
#define IVORY_MERGE_OUTSIDE(S, FIRST) uint o = IVORY_IN_BOTH(outside, S, FIRST);
#define IVORY_MERGE_TAKEN(S) uint taken = S + 1 <= finest ? d | b : 0u; taken |= taken << uint(1 << S);
#define IVORY_MERGE_TAKE(S) IVORY_MERGE_TAKEN(S) IVORY_TAKE_LEAVES(S, j, taken) IVORY_TAKE_LEAVES(S, k, taken)
#define IVORY_MERGE_STORE dark[j] = d; bright[j] = b; outside[j] = o;
#define IVORY_MERGE(S, FIRST) IVORY_MERGE_DARK(S, FIRST) IVORY_MERGE_OUTSIDE(S, FIRST) IVORY_MERGE_TAKE(S) IVORY_MERGE_STORE
#define IVORY_ROW_PAIRS(S) for (int j = 0, k = 1 << S; j < IVORY_LEAF_SIZE; j += 2 << S, k += 2 << S)
#define IVORY_MERGE_LEVEL(S, FIRST) IVORY_ROW_PAIRS(S) { IVORY_MERGE(S, FIRST) }

// Blocks above `least_level` (0 to IVORY_LEAF_DEPTH) are split, dark and lit ones alike.
IvoryMaskLeaves ivory_mask_leaves(uint rows[IVORY_MASK_SIZE], int least_level) {
  const uint all = IVORY_LEAF_DEPTH == 5 ? ~0u : (1u << uint(IVORY_LEAF_SIZE)) - 1u;
  int finest = IVORY_LEAF_DEPTH - least_level;  // levels above the grid that leaves may lie
  uint dark[IVORY_LEAF_SIZE];
  uint bright[IVORY_LEAF_SIZE];
  uint outside[IVORY_LEAF_SIZE];
  IvoryMaskLeaves leaves;
  for (int j = 0; j < IVORY_LEAF_SIZE; ++j) {
    uint row = rows[j >> (IVORY_LEAF_DEPTH - IVORY_MASK_DEPTH)];
#if IVORY_LEAF_DEPTH > IVORY_MASK_DEPTH
    uint wide = 0u;
    for (int i = 0; i < IVORY_LEAF_SIZE; ++i)
      wide |= ((row >> uint(i >> (IVORY_LEAF_DEPTH - IVORY_MASK_DEPTH))) & 1u) << uint(i);
    row = wide;
#endif
    outside[j] = ivory_outside_row(j);
    dark[j] = row | outside[j];
    bright[j] = (~row & all) | outside[j];
    leaves.anchor[j] = 0u;
    leaves.lit[j] = 0u;
    leaves.above0[j] = 0u;
    leaves.above1[j] = 0u;
    leaves.above2[j] = 0u;
  }
#if IVORY_LEAF_DEPTH > 0
  IVORY_MERGE_LEVEL(0, 0x55555555u)
#endif
#if IVORY_LEAF_DEPTH > 1
  IVORY_MERGE_LEVEL(1, 0x11111111u)
#endif
#if IVORY_LEAF_DEPTH > 2
  IVORY_MERGE_LEVEL(2, 0x01010101u)
#endif
#if IVORY_LEAF_DEPTH > 3
  IVORY_MERGE_LEVEL(3, 0x00010001u)
#endif
#if IVORY_LEAF_DEPTH > 4
  IVORY_MERGE_LEVEL(4, 0x00000001u)
#endif
  IVORY_TAKE_LEAVES(IVORY_LEAF_DEPTH, 0, 0u)
  leaves.rows = 0u;
  for (int j = 0; j < IVORY_LEAF_SIZE; ++j) leaves.rows |= (leaves.anchor[j] != 0u ? 1u : 0u) << uint(j);
  return leaves;
}

// Index of a power of two.
int ivory_bit_index(uint power_of_two) { return ((floatBitsToInt(float(int(power_of_two))) >> 23) & 255) - 127; }

// A walk over the leaves, each once:
//   IvoryLeafWalk walk = ivory_begin_leaves(leaves);
//   do { IvoryMaskLeaf leaf = ivory_next_leaf(walk, leaves, blocks, cap); ... } while (ivory_more_leaves(walk));
struct IvoryLeafWalk {
  uint rows;
  int row;
  uint bits;
};
IvoryLeafWalk ivory_begin_leaves(IvoryMaskLeaves leaves) { return IvoryLeafWalk(leaves.rows, 0, 0u); }
bool ivory_more_leaves(IvoryLeafWalk walk) { return (walk.bits | walk.rows) != 0u; }

// ivory_spread_lobe(axis, height, spread) is the leaf's lobe.
struct IvoryMaskLeaf {
  vec3 axis;
  float height;  // solid angle over 2 pi
  float spread;  // 1 - mean cosine to the axis
  int level;     // 0 is the whole square
  bool lit;
};

// The block's leaf. `blocks` (RGBA32F, from ivory::bind(GpuLobes)) holds all levels' blocks, two texels each: centroid,
// area, variance; a, b (grid/lobes/visibility.h, MaskBlock).
IvoryMaskLeaf ivory_make_leaf(samplerBuffer blocks, int block, IvoryLightCap cap, int level, bool lit) {
  vec4 b = texelFetch(blocks, 2 * block);
  vec2 r2 = texelFetch(blocks, 2 * block + 1).xy;
  float t2 = cap.tan_half * cap.tan_half;
  // The stereographic plane's point back on the sphere.
  vec2 at = b.xy * cap.tan_half;
  float q = 1.0 / (1.0 + at.x * at.x + at.y * at.y);
  vec3 axis = cap.x * (2.0 * at.x * q) + cap.y * (2.0 * at.y * q) + cap.z * ((1.0 - at.x * at.x - at.y * at.y) * q);
  float bracket = 1.0 / ((1.0 + t2 * r2.x) * (1.0 + t2 * r2.y));
  return IvoryMaskLeaf(axis, 4.0 * t2 * b.z * bracket / (2.0 * ivory_pi), 2.0 * t2 * b.w * bracket, level, lit);
}

IvoryMaskLeaf ivory_next_leaf(inout IvoryLeafWalk walk, IvoryMaskLeaves leaves, samplerBuffer blocks,
                              IvoryLightCap cap) {
  if (walk.bits == 0u) {
    uint first = walk.rows & (~walk.rows + 1u);
    walk.rows ^= first;
    walk.row = ivory_bit_index(first);
    walk.bits = leaves.anchor[walk.row];
  }
  int row = walk.row;
  uint bit = walk.bits & (~walk.bits + 1u);
  walk.bits ^= bit;
  int above = ((leaves.above0[row] & bit) != 0u ? 1 : 0) + ((leaves.above1[row] & bit) != 0u ? 2 : 0) +
              ((leaves.above2[row] & bit) != 0u ? 4 : 0);
  int level = IVORY_LEAF_DEPTH - above;
  int block = ((1 << (2 * level)) - 1) / 3 + ((row >> above) << level) + (ivory_bit_index(bit) >> above);
  return ivory_make_leaf(blocks, block, cap, level, (leaves.lit[row] & bit) != 0u);
}
