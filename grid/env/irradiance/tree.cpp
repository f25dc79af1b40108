#include "grid/env/irradiance/tree.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

// E(n) = integral of L max(0, n.w). Over a cell wholly above the horizon max(0, n.w) = n.w, so the cell gives n.V with
// V = integral of L w, exactly, however its light is spread. In a cell on the horizon let x = n.w vary within [lo, hi],
// lo < 0 < hi, with the known mean a = n.V / flux. max(0, x) is convex, so by Jensen's inequality from below and by its
// chord from above
//
//   flux max(0, a)  <=  integral of L max(0, x)  <=  flux (a - lo) hi / (hi - lo).
//
// Light spread evenly over a square cell has the variance of x spread evenly over a mean +- u with u half the square's
// edge, which makes the integral flux (a + u)^2 / (4 u) for |a| < u: the estimate, held between the two bounds. Their
// distance from it is the error, for a whole cell at most flux times half its half-width.

namespace ivory {

namespace {

// Between unit vectors, with all digits for small angles.
double angle(const V3d& a, const V3d& b) { return std::atan2(a.cross(b).length(), a.dot(b)); }

}  // namespace

IrradianceTree::IrradianceTree(int size) : size_(size) {
  assert(size > 0 && (size & (size - 1)) == 0);
  for (int edge = 1; edge <= size; edge *= 2) {
    std::vector<Cell>& cells = levels_.emplace_back(std::size_t(cube_faces) * std::size_t(edge) * std::size_t(edge));
    for (int face = 0; face < cube_faces; ++face) {
      for (int row = 0; row < edge; ++row) {
        for (int column = 0; column < edge; ++column)
          cells[cube_index(edge, face, row, column)].axis = V3d(cube_texel_direction(edge, face, row, column));
      }
    }
  }
}

void IrradianceTree::add(const Rgb& radiance, double solid_angle, const V3d& first, double half_angle_rad) {
  if (is_black(radiance) || !(solid_angle > 0)) return;
  const double length = first.length();
  const V3d mean = length > 0 ? first / length : V3d(0, 0, 1);
  Cell& cell = levels_.back()[cube_texel(size_, V3f(mean))];
  const V3d value(radiance);
  cell.flux += value * solid_angle;
  for (std::size_t i = 0; i < 3; ++i) cell.vector[i] += value * first[unsigned(i)];
  cell.half_angle = std::max(cell.half_angle, angle(mean, cell.axis) + half_angle_rad);
}

void IrradianceTree::finish() {
  for (std::size_t level = levels_.size(); level-- > 0;) {
    const int edge = 1 << level;
    for (int face = 0; face < cube_faces; ++face) {
      for (int row = 0; row < edge; ++row) {
        for (int column = 0; column < edge; ++column) {
          Cell& cell = levels_[level][cube_index(edge, face, row, column)];
          if (level + 1 < levels_.size()) {
            for (int child = 0; child < 4; ++child) {
              const Cell& part =
                  levels_[level + 1][cube_index(2 * edge, face, 2 * row + child / 2, 2 * column + child % 2)];
              if (part.flux == V3d(0, 0, 0)) continue;
              cell.flux += part.flux;
              for (std::size_t i = 0; i < 3; ++i) cell.vector[i] += part.vector[i];
              cell.half_angle = std::max(cell.half_angle, angle(cell.axis, part.axis) + part.half_angle);
            }
          }
          const bool wide = cell.half_angle >= std::numbers::pi / 2;
          cell.sine = wide ? 2 : std::sin(cell.half_angle);
          cell.cosine = wide ? 0 : std::cos(cell.half_angle);
        }
      }
    }
  }
}

void IrradianceTree::visit(std::size_t level, int face, int row, int column, const V3d& n, const V3d& allowed,
                           Estimate& sum) const {
  const int edge = 1 << level;
  const Cell& cell = levels_[level][cube_index(edge, face, row, column)];
  if (cell.flux == V3d(0, 0, 0)) return;
  const double d = n.dot(cell.axis);
  if (d <= -cell.sine) return;
  const V3d projected = cell.vector[0] * n.x + cell.vector[1] * n.y + cell.vector[2] * n.z;
  if (d >= cell.sine) {
    sum.e += projected;
    return;
  }
  double lo = -1;
  double hi = 1;
  if (cell.sine < 2) {
    const double across = std::sqrt(std::max(0.0, 1 - d * d)) * cell.sine;
    lo = std::min(d * cell.cosine - across, 0.0);
    hi = std::max(d * cell.cosine + across, 0.0);
  }
  const double u = std::sqrt(0.5) * std::min(cell.sine, 1.0);
  V3d e;
  V3d error;
  bool good = true;
  for (int c = 0; c < 3; ++c) {
    const double below = std::max(0.0, projected[c]);
    const double above = std::max(below, hi > lo ? (projected[c] - lo * cell.flux[c]) * hi / (hi - lo) : 0.0);
    const double shifted = std::max(0.0, projected[c] + u * cell.flux[c]);
    e[c] = cell.flux[c] > 0 ? std::clamp(shifted * shifted / (4 * u * cell.flux[c]), below, above) : 0.0;
    error[c] = std::max(above - e[c], e[c] - below);
    good = good && error[c] <= allowed[c];
  }
  if (good || level + 1 == levels_.size()) {
    sum.e += e;
    sum.error += error;
    return;
  }
  for (int child = 0; child < 4; ++child)
    visit(level + 1, face, 2 * row + child / 2, 2 * column + child % 2, n, allowed, sum);
}

IrradianceTree::Estimate IrradianceTree::irradiance(const V3d& n, double tolerance) const {
  Estimate sum;
  const V3d allowed = total() * tolerance;
  for (int face = 0; face < cube_faces; ++face) visit(0, face, 0, 0, n, allowed, sum);
  return sum;
}

V3d IrradianceTree::total() const {
  V3d sum(0, 0, 0);
  for (const Cell& face : levels_.front()) sum += face.flux;
  return sum;
}

}  // namespace ivory
