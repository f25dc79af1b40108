// One axis of a texture as cells: between two neighbouring texel centres, where bilinear filtering is linear, or one
// texel each where the nearest is taken. Cells are numbered without bound along the wrapped texture, and stored once.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tracer/core/scene.h"

namespace ivory {

struct CellAxis {
  enum class Order {
    repeat,        // 0 1 2 0 1 2
    mirror_ends,   // 0 1 2 2 1 0: texels
    mirror_inner,  // 0 1 2 1 0 1: pairs of texels, of which those across the ends stand alone
    clamp          // the first and the last reach to infinity
  };
  Order order = Order::repeat;
  int count = 1;             // cells stored
  int first_texel = 0;       // left or upper texel of cell 0
  double shift = 0;          // texels from the image's edge to cell 0's, leftward
  double cells_a_texel = 1;  // below 1 where cells are joined to blocks

  // Unbounded coordinate in cells of one in texels.
  double at(double texels) const { return (texels + shift) * cells_a_texel; }
  // The unbounded cell that holds it; with clamp one of those stored.
  int cell(double coordinate) const {
    const int i = int(std::floor(coordinate));
    return order == Order::clamp ? std::clamp(i, 0, count - 1) : i;
  }
  // Last cell of a range that ends at `coordinate`, which its cells share no more than an edge with.
  int last_cell(int first, double coordinate) const {
    const int i = std::max(first, int(std::ceil(coordinate)) - 1);
    return order == Order::clamp ? std::clamp(i, 0, count - 1) : i;
  }
  // After how many cells they come again; with clamp all.
  int period() const {
    if (order == Order::mirror_ends) return 2 * count;
    return order == Order::mirror_inner ? std::max(1, 2 * (count - 1)) : count;
  }
  // Which stored one an unbounded cell is.
  int stored(int i) const {
    if (i >= 0 && i < count) return i;
    if (order == Order::clamp) return std::clamp(i, 0, count - 1);
    const int p = period();
    const int r = ((i % p) + p) % p;
    if (r < count) return r;
    return order == Order::mirror_ends ? p - 1 - r : p - r;
  }
};

// Of `texels` texels.
inline CellAxis make_cell_axis(int texels, Wrap wrap, bool nearest) {
  if (wrap == Wrap::repeat) return {CellAxis::Order::repeat, texels, 0, nearest ? 0.0 : -0.5, 1};
  const bool mirror = wrap == Wrap::mirrored_repeat;
  if (nearest) return {mirror ? CellAxis::Order::mirror_ends : CellAxis::Order::clamp, texels, 0, 0, 1};
  return {mirror ? CellAxis::Order::mirror_inner : CellAxis::Order::clamp, texels + 1, -1, 0.5, 1};
}

// The same axis in blocks of about `cells` cells, a whole number of them a period.
inline CellAxis joined(const CellAxis& axis, int cells) {
  const int blocks = std::max(1, (axis.period() + cells - 1) / cells);
  return {axis.order == CellAxis::Order::clamp ? CellAxis::Order::clamp : CellAxis::Order::repeat, blocks, 0,
          axis.shift, double(blocks) / axis.period()};
}

// Sum of `value` over the unbounded cells from 0 to before i (negative for negative i), where prefix(k) is the sum over
// the first k stored ones. With clamp, i is within those stored.
template <typename Value, typename Prefix, typename Cell>
Value sum_before(const CellAxis& axis, int i, const Prefix& prefix, const Cell& value) {
  const int n = axis.count;
  if (axis.order == CellAxis::Order::clamp || (i >= 0 && i <= n)) return prefix(i);
  const int p = axis.period();
  const int r = ((i % p) + p) % p;
  const double periods = double((i - r) / p);
  switch (axis.order) {
    case CellAxis::Order::mirror_ends: {
      const Value all = prefix(n);
      return all * (2 * periods) + (r <= n ? prefix(r) : all * 2.0 - prefix(p - r));
    }
    case CellAxis::Order::mirror_inner: {
      const Value all = prefix(n);
      if (n == 1) return all * double(i);
      const Value turn = all * 2.0 - value(0) - value(n - 1);
      return turn * periods + (r <= n ? prefix(r) : all + prefix(n - 1) - prefix(2 * n - 1 - r));
    }
    default:
      return prefix(n) * periods + prefix(r);
  }
}

}  // namespace ivory
