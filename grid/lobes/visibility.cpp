#include "grid/lobes/visibility.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

// The light's square is the stereographic plane around the light's axis: d = (x, y, z) goes to (x, y)/(1 + z), in units
// of tan(half-angle/2), so that the light's cap is the unit disc. Every other cap is an exact disc there too: that of
// axis o and half-angle theta has centre (o.x, o.y)/(o.z + cos theta) and radius sin theta/(o.z + cos theta), and where
// o.z + cos theta < 0 it is what lies outside that disc. A row of cells is then dark in an interval, found by one
// square root and written as bits.
//
// Solid angle on the plane is 4 t^2/(1 + t^2 r^2)^2 dA, t = tan(half-angle/2). A block's share of the cap is its area
// in the disc times the mean of the bracket, which for r^2 uniform over [a, b] is 1/((1 + t^2 a)(1 + t^2 b)); a and b
// are chosen from the mean and variance of r^2 over the block. The whole disc has a = 0, b = 1, which is exact.

namespace ivory {

namespace {

struct BlockTable {
  // Level l: 4^l blocks, row by row, from offset (4^l - 1)/3.
  std::array<MaskBlock, (4 * max_mask_leaves - 1) / 3> blocks;
  // Per level and row: the blocks that lie outside the disc altogether.
  std::array<std::array<std::uint32_t, max_mask_size>, max_mask_depth + 1> outside;
};

constexpr int level_offset(int level) { return ((1 << (2 * level)) - 1) / 3; }

// Integrals over the unit disc's part of a finest cell, by a fine grid of points; coarser blocks add them up.
struct Sums {
  double area = 0, x = 0, y = 0, r2 = 0, r4 = 0;

  void add(const Sums& s) {
    area += s.area;
    x += s.x;
    y += s.y;
    r2 += s.r2;
    r4 += s.r4;
  }
};

BlockTable make_block_table() {
  constexpr int sub = 16;  // points a side of a finest cell: shares to about 1e-5 of the disc
  std::vector<Sums> sums(max_mask_leaves);
  const double cell = 2.0 / max_mask_size;
  for (int j = 0; j < max_mask_size * sub; ++j) {
    for (int i = 0; i < max_mask_size * sub; ++i) {
      const double x = (i + 0.5) / sub * cell - 1;
      const double y = (j + 0.5) / sub * cell - 1;
      const double r2 = x * x + y * y;
      if (r2 < 1) sums[std::size_t((j / sub) * max_mask_size + i / sub)].add({1, x, y, r2, r2 * r2});
    }
  }
  BlockTable table;
  std::vector<Sums> level_sums = sums;
  for (int level = max_mask_depth; level >= 0; --level) {
    const int n = 1 << level;
    for (int j = 0; j < n; ++j) {
      std::uint32_t outside = 0;
      for (int i = 0; i < n; ++i) {
        const Sums& s = level_sums[std::size_t(j * n + i)];
        MaskBlock& block = table.blocks[std::size_t(level_offset(level) + j * n + i)];
        block = MaskBlock();
        if (s.area == 0) {
          outside |= 1U << unsigned(i);
          continue;
        }
        const double mean = s.r2 / s.area;
        const double spread = std::sqrt(3 * std::max(0.0, s.r4 / s.area - mean * mean));
        block = {float(s.x / s.area),
                 float(s.y / s.area),
                 float(s.area * cell * cell / (sub * sub)),
                 float(std::max(0.0, mean - spread)),
                 float(mean + spread),
                 float(mean - (s.x * s.x + s.y * s.y) / (s.area * s.area))};
      }
      table.outside[std::size_t(level)][std::size_t(j)] = outside;
    }
    if (level == 0) break;
    std::vector<Sums> parents(std::size_t(n / 2) * std::size_t(n / 2));
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i)
        parents[std::size_t((j / 2) * (n / 2) + i / 2)].add(level_sums[std::size_t(j * n + i)]);
    }
    level_sums = std::move(parents);
  }
  return table;
}

const BlockTable& block_table() {
  static const BlockTable table = make_block_table();
  return table;
}

// Bits 0, 2, 4 ... of x side by side.
std::uint32_t even_bits(std::uint32_t x) {
  x &= 0x55555555U;
  x = (x | (x >> 1U)) & 0x33333333U;
  x = (x | (x >> 2U)) & 0x0f0f0f0fU;
  x = (x | (x >> 4U)) & 0x00ff00ffU;
  return (x | (x >> 8U)) & 0x0000ffffU;
}

using Rows = std::array<std::uint32_t, max_mask_size>;

// 1 - mean cosine is half the mean square of the angle, which is 2 t/(1 + t^2 r^2) a unit of the plane.
float block_spread(const MaskBlock& block, float t2) {
  return 2 * t2 * block.variance / ((1 + t2 * block.a) * (1 + t2 * block.b));
}

float block_height(const MaskBlock& block, float t2) {
  return 4 * t2 * block.area / ((1 + t2 * block.a) * (1 + t2 * block.b)) / (2 * pi);
}

}  // namespace

std::span<const MaskBlock> mask_blocks() { return block_table().blocks; }

LightCap make_light_cap(const Sphere& light, const V3f& p) {
  const V3f d = light.center - p;
  const float distance = d.length();
  assert(distance > light.radius_m);
  LightCap cap;
  cap.z = d / distance;
  // Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
  const float sign = std::copysign(1.0F, cap.z.z);
  const float a = -1.0F / (sign + cap.z.z);
  const float b = cap.z.x * cap.z.y * a;
  cap.x = V3f(1.0F + sign * cap.z.x * cap.z.x * a, sign * b, -sign * cap.z.x);
  cap.y = V3f(b, sign + cap.z.y * cap.z.y * a, -cap.z.y);
  cap.height = sphere_cap_height(light.radius_m, distance);
  cap.tan_half = std::sqrt(cap.height / (2 - cap.height));
  return cap;
}

ShadowMask make_shadow_mask(const Sphere& light, const LightCap& cap, const V3f& p, std::span<const Sphere> spheres,
                            int depth, MaskRule rule) {
  assert(depth >= 0 && depth <= max_mask_depth);
  ShadowMask mask;
  mask.depth = depth;
  const int n = 1 << depth;
  const std::uint32_t all = n == 32 ? ~0U : (1U << unsigned(n)) - 1;
  const float light_power = power(light, p);
  const float to_plane = 1 / cap.tan_half;
  const float half = 0.5F * float(n);
  const float grow =
      rule == MaskRule::center ? 0 : (rule == MaskRule::inside ? -1.0F : 1.0F) * std::sqrt(2.0F) / float(n);
  for (const Sphere& sphere : spheres) {
    const V3f d = sphere.center - p;
    const float distance2 = d.length2();
    const float tangent2 = distance2 - sphere.radius_m * sphere.radius_m;
    if (!(tangent2 > 0) || tangent2 >= light_power) continue;
    // In units of the distance: o.z + cos theta = (d.z + sqrt(tangent2))/|d| and sin theta = radius/|d|.
    const float z = d.dot(cap.z) + std::sqrt(tangent2);
    const bool inverted = z <= 0;  // the cap holds the direction opposite to the light
    const float scale = to_plane / (z != 0 ? z : -1e-20F);
    const float cx = d.dot(cap.x) * scale;
    const float cy = d.dot(cap.y) * scale;
    float radius = sphere.radius_m * std::abs(scale) + (inverted ? -grow : grow);
    const float off2 = cx * cx + cy * cy;
    if (!inverted) {
      if (!(radius > 0) || off2 >= (1 + radius) * (1 + radius)) continue;
    } else {
      radius = std::max(radius, 0.0F);
      if (radius >= 1 && off2 <= (radius - 1) * (radius - 1)) continue;
    }
    if (!mask.any) {
      mask.any = true;
      mask.rows.fill(0);
    }
    const float radius2 = radius * radius;
    const float first = (cx + 1) * half - 0.5F;
    // Rows whose centres lie within the disc; of an inverted one all count.
    const float middle = (cy + 1) * half - 0.5F;
    const int begin = inverted ? 0 : int(std::clamp(std::ceil(middle - radius * half), 0.0F, float(n)));
    const int end = inverted ? n : int(std::clamp(std::floor(middle + radius * half) + 1, 0.0F, float(n)));
    const std::uint32_t flip = inverted ? ~0U : 0U;
    // Without branches, so that rows go eight at a time.
    for (int j = begin; j < end; ++j) {
      const float y = (float(j) + 0.5F) / half - 1 - cy;
      const float w2 = radius2 - y * y;
      const float w = std::sqrt(std::max(w2, 0.0F)) * half;
      // Cells whose centres lie within [first - w, first + w].
      const float low = std::max(std::ceil(first - w), 0.0F);
      const float high = std::min(std::floor(first + w), 31.0F);
      const std::uint32_t from = ~0U << unsigned(int(std::min(low, 31.0F)));
      const std::uint32_t to = ~0U >> unsigned(31 - int(std::max(high, 0.0F)));
      const bool any = low <= high && w2 > 0;
      const std::uint32_t inside = any ? from & to : 0U;
      mask.rows[std::size_t(j)] |= (inside ^ flip) & all;
    }
  }
  return mask;
}

namespace {

// Each bit twice, from the low 16 bits.
std::uint32_t doubled_bits(std::uint32_t x) {
  x &= 0xffffU;
  x = (x | (x << 8U)) & 0x00ff00ffU;
  x = (x | (x << 4U)) & 0x0f0f0f0fU;
  x = (x | (x << 2U)) & 0x33333333U;
  x = (x | (x << 1U)) & 0x55555555U;
  return x | (x << 1U);
}

std::uint32_t all_bits(int level) { return level == 5 ? ~0U : (1U << (1U << unsigned(level))) - 1; }

}  // namespace

int mask_leaves(const ShadowMask& mask, const LightCap& cap, std::span<MaskLeaf> leaves, int least_level) {
  const BlockTable& table = block_table();
  const float t2 = cap.tan_half * cap.tan_half;
  int count = 0;
  const auto emit = [&](int level, int i, int j, bool lit) {
    const int n = 1 << level;
    const MaskBlock& block = table.blocks[std::size_t(level_offset(level) + j * n + i)];
    // The stereographic plane's point back on the sphere.
    const float x = block.x * cap.tan_half;
    const float y = block.y * cap.tan_half;
    const float q = 1 / (1 + x * x + y * y);
    MaskLeaf& leaf = leaves[std::size_t(count++)];
    leaf.axis = cap.x * (2 * x * q) + cap.y * (2 * y * q) + cap.z * ((1 - x * x - y * y) * q);
    leaf.height = block_height(block, t2);
    leaf.spread = block_spread(block, t2);
    leaf.level = level;
    leaf.lit = lit;
  };
  if (!mask.any && least_level == 0) {
    emit(0, 0, 0, true);
    return count;
  }

  // Rows of the finest level that leaves may lie on, then up: which blocks are dark, which are lit, throughout. What
  // lies outside the disc is both.
  const int finest = std::max(mask.any ? mask.depth : 0, least_level);
  std::array<Rows, max_mask_depth + 1> dark;
  std::array<Rows, max_mask_depth + 1> lit;
  Rows rows{};
  if (mask.any) rows = mask.rows;
  for (int level = mask.depth; mask.any && level < finest; ++level) {
    for (int j = (1 << (level + 1)) - 1; j >= 0; --j) rows[std::size_t(j)] = doubled_bits(rows[std::size_t(j / 2)]);
  }
  for (int j = 0; j < 1 << finest; ++j) {
    const auto row = std::size_t(j);
    const std::uint32_t outside = table.outside[std::size_t(finest)][row];
    dark[std::size_t(finest)][row] = rows[row] | outside;
    lit[std::size_t(finest)][row] = ~rows[row] | outside;
  }
  for (int level = finest - 1; level >= 0; --level) {
    for (int j = 0; j < 1 << level; ++j) {
      const auto merge = [&](std::array<Rows, max_mask_depth + 1>& levels) {
        const Rows& fine = levels[std::size_t(level + 1)];
        const std::uint32_t both = fine[std::size_t(2 * j)] & fine[std::size_t(2 * j + 1)];
        levels[std::size_t(level)][std::size_t(j)] = even_bits(both & (both >> 1U));
      };
      merge(dark);
      merge(lit);
    }
  }
  for (int level = least_level; level <= finest; ++level) {
    for (int j = 0; j < 1 << level; ++j) {
      const auto row = std::size_t(j);
      std::uint32_t uniform = (dark[std::size_t(level)][row] | lit[std::size_t(level)][row]) & all_bits(level) &
                              ~table.outside[std::size_t(level)][row];
      if (level > least_level)
        uniform &= ~doubled_bits(dark[std::size_t(level - 1)][row / 2] | lit[std::size_t(level - 1)][row / 2]);
      for (; uniform != 0; uniform &= uniform - 1) {
        const int i = std::countr_zero(uniform);
        emit(level, i, j, (lit[std::size_t(level)][row] >> unsigned(i) & 1U) != 0);
      }
    }
  }
  return count;
}

}  // namespace ivory
