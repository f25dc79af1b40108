// A triangle cut along the cells of its texture. Everything is linear in barycentric coordinates, so that triangles
// whose texture is squeezed to a line or a point need no case of their own.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "grid/base/types.h"
#include "tracer/lights/emission/cell_axis.h"

namespace ivory {

struct TexelCorner {
  double b1, b2;  // weights of the triangle's 2nd and 3rd vertex
  double x, y;    // unbounded coordinates in cells
};

// Convex. A triangle cut by four lines has at most seven corners.
struct TexelPolygon {
  std::array<TexelCorner, 8> corners;
  std::size_t count = 0;

  bool empty() const { return count < 3; }
};

// The part where coordinate `axis` is at least `bound` (keep_above) or at most it. Points on the cut have just that.
inline TexelPolygon clipped(const TexelPolygon& polygon, double TexelCorner::*axis, double bound, bool keep_above) {
  TexelPolygon out;
  const auto inside = [&](double value) { return keep_above ? value >= bound : value <= bound; };
  for (std::size_t k = 0; k < polygon.count; ++k) {
    const TexelCorner& a = polygon.corners[k];
    const TexelCorner& b = polygon.corners[k + 1 == polygon.count ? 0 : k + 1];
    const bool a_inside = inside(a.*axis);
    if (a_inside && out.count < out.corners.size()) out.corners[out.count++] = a;
    if (a_inside == inside(b.*axis)) continue;
    const double t = (bound - a.*axis) / (b.*axis - a.*axis);
    TexelCorner cut{a.b1 + (b.b1 - a.b1) * t, a.b2 + (b.b2 - a.b2) * t, a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t};
    cut.*axis = bound;
    if (out.count < out.corners.size()) out.corners[out.count++] = cut;
  }
  return out;
}

// In barycentric coordinates, of which the whole triangle covers one half.
inline double area_of(const TexelCorner& a, const TexelCorner& b, const TexelCorner& c) {
  return 0.5 * std::abs((b.b1 - a.b1) * (c.b2 - a.b2) - (c.b1 - a.b1) * (b.b2 - a.b2));
}
inline double area_of(const TexelPolygon& polygon) {
  double area = 0;
  for (std::size_t k = 2; k < polygon.count; ++k)
    area += area_of(polygon.corners[0], polygon.corners[k - 1], polygon.corners[k]);
  return area;
}

inline std::array<double, 2> range_of(const TexelPolygon& polygon, double TexelCorner::*axis) {
  std::array<double, 2> range{polygon.corners[0].*axis, polygon.corners[0].*axis};
  for (std::size_t k = 1; k < polygon.count; ++k) {
    range[0] = std::min(range[0], polygon.corners[k].*axis);
    range[1] = std::max(range[1], polygon.corners[k].*axis);
  }
  return range;
}

// What lies in unbounded cell i of an axis; the cells at the ends of a clamped one reach to infinity.
inline TexelPolygon clipped_to_cell(TexelPolygon polygon, const CellAxis& cells, double TexelCorner::*axis, int i) {
  const bool clamp = cells.order == CellAxis::Order::clamp;
  if (!clamp || i > 0) polygon = clipped(polygon, axis, i, true);
  if (!clamp || i < cells.count - 1) polygon = clipped(polygon, axis, i + 1, false);
  return polygon;
}

// First and last cell along an axis.
inline std::array<int, 2> cells_of(const TexelPolygon& polygon, const CellAxis& cells, double TexelCorner::*axis) {
  const std::array<double, 2> range = range_of(polygon, axis);
  const int first = cells.cell(range[0]);
  return {first, cells.last_cell(first, range[1])};
}

// The cells in row j of a triangle: on_run(begin, end) for those that it covers whole, on_cell(i, polygon) for the
// others.
template <typename OnRun, typename OnCell>
void visit_row(const TexelPolygon& triangle, const CellAxis& x, const CellAxis& y, int j, const OnRun& on_run,
               const OnCell& on_cell) {
  TexelPolygon rest = clipped_to_cell(triangle, y, &TexelCorner::y, j);
  if (rest.empty()) return;
  const auto [first, last] = cells_of(rest, x, &TexelCorner::x);

  // Between the row's two edges a convex polygon covers whole what it covers of both.
  double left[2] = {1, 1};
  double right[2] = {0, 0};
  for (std::size_t k = 0; k < rest.count; ++k) {
    const TexelCorner& c = rest.corners[k];
    for (int edge = 0; edge < 2; ++edge) {
      if (c.y != j + edge) continue;
      const bool none = left[edge] > right[edge];
      left[edge] = none ? c.x : std::min(left[edge], c.x);
      right[edge] = none ? c.x : std::max(right[edge], c.x);
    }
  }
  int begin = last + 1;
  int end = last + 1;
  const bool endless = y.order == CellAxis::Order::clamp && (j == 0 || j == y.count - 1);
  if (!endless && left[0] <= right[0] && left[1] <= right[1]) {
    begin = std::max(first, int(std::ceil(std::max(left[0], left[1]))));
    end = std::min(last + 1, int(std::floor(std::min(right[0], right[1]))));
    if (x.order == CellAxis::Order::clamp) {
      begin = std::max(begin, 1);
      end = std::min(end, x.count - 1);
    }
    if (end <= begin) begin = end = last + 1;
  }
  for (int i = first; i <= last; ++i) {
    if (i == begin && end > begin) {
      on_run(begin, end);
      rest = clipped(rest, &TexelCorner::x, end, true);
      i = end - 1;
      continue;
    }
    const TexelPolygon piece = i < last ? clipped(rest, &TexelCorner::x, i + 1, false) : rest;
    if (!piece.empty()) on_cell(i, piece);
    if (i < last) rest = clipped(rest, &TexelCorner::x, i + 1, true);
  }
}

}  // namespace ivory
