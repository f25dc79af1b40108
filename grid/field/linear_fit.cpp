#include "grid/field/linear_fit.h"

#include <algorithm>
#include <cmath>

#include "grid/field/guard.h"

// Interpolation takes a vertex's value as that of its place. But it is the mean over the part of a cell that the vertex
// sees, and a point on a surface is read from vertices on one side of it: where light falls off towards the surface, as
// it does in corners and at contacts, interpolated E is too bright.
//
// So a linear field a + g.(x - p) is fitted to the values f_i, measured at x_i, with the weights w_i that interpolation
// gives them (sum 1), and a is read:
//
//   minimise sum_i w_i (a + g.(x_i - p) - f_i)^2 + r |g|^2
//
// With the mean m = sum w_i x_i, d_i = x_i - m and C = sum w_i d_i d_i^T + r I this is
//
//   a = sum_i w_i (1 + d_i . C^-1 (p - m)) f_i,
//
// new weights, the same for all functions of all bases. They add up to one, as sum w_i d_i = 0. For r = 0 they
// reproduce any linear field. As |d| |p - m| / (d^2 + r) <= |p - m| / (2 sqrt(r)), a weight changes by at most three
// times itself for r = 0.03 and |p - m| = 1 voxel.
//
// The ridge stands for what is believed of g beforehand: r is noise over the expected square of a gradient. Its parts:
// 0.03 keeps the matrix regular, and 300 relative variances of a vertex. Both were chosen on two rooms at three
// spacings and two numbers of photons (docs/methods/field.md): with 100 noise grows where photons are few, with 1000
// the fit loses half of its gain.

namespace ivory {
namespace {

constexpr float least_ridge = 0.03F;  // voxels^2
constexpr float ridge_of_noise = 300;

// Light of all directions, per channel: 2 pi L in uniform light L.
Rgb intensity(Basis basis, const float* m) {
  const auto at = [&](int function, float scale) {
    return Rgb(m[3 * function], m[3 * function + 1], m[3 * function + 2]) * scale;
  };
  constexpr float third = 1.0F / 3;
  switch (basis) {
    case Basis::vectors:  // the integrals of L |w_i|
      return at(3, third) + at(7, third) + at(11, third);
    case Basis::vectors9:
      return at(3, third) + at(4, third) + at(5, third);
    case Basis::ambient_cube:
      return at(0, third) + at(1, third) + at(2, third) + at(3, third) + at(4, third) + at(5, third);
    case Basis::sh9:
    case Basis::sh4:
      return at(0, 1.7724539F);  // sqrt(pi): Y_00 is 1 / (2 sqrt(pi))
  }
  return {0, 0, 0};
}

// Where levels meet, voxels are between theirs in size.
V3f mean_spacing(const IrradianceGrid& grid, const Footprint& seen) {
  if (grid.levels() == 1) return grid.frame.spacing_m;
  V3f mean(0, 0, 0);
  float sum = 0;
  for (std::size_t i = 0; i < std::size_t(seen.count); ++i) {
    mean += grid.frame_of(grid.level_of(seen.vertex[i])).spacing_m * seen.weight[i];
    sum += seen.weight[i];
  }
  return mean / sum;
}

}  // namespace

// A plane n.u <= d cuts the cell, which reaches h = (|n_x| + |n_y| + |n_z|) / 2 along n: its middle moves by (d - h)
// / 2.
V3f measured_at(const GuardRecord& record) {
  V3f middle(0, 0, 0);
  for (const std::uint32_t word : record.words) {
    const std::optional<GuardPlane> plane = unpack(word);
    if (!plane) continue;
    const V3f& n = plane->normal;
    const float reach = 0.5F * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
    middle += n * (0.5F * (std::clamp(plane->distance, -reach, reach) - reach));
  }
  constexpr float most = 0.45F;
  return {std::clamp(middle.x, -most, most), std::clamp(middle.y, -most, most), std::clamp(middle.z, -most, most)};
}

float relative_variance(const IrradianceGrid& grid, std::size_t vertex) {
  const Rgb light = intensity(grid.basis, grid.at(vertex));
  const Rgb& variance = grid.variance[vertex];
  const float square = light.dot(light);
  return square > 0 ? std::min(1.0F, (variance.x + variance.y + variance.z) / square) : 0;
}

Footprint fit_linear(const IrradianceGrid& grid, const V3f& p, const Footprint& seen) {
  const auto count = std::size_t(seen.count);
  const V3f unit_m = mean_spacing(grid, seen);
  std::array<V3f, max_footprint> d;
  V3f mean(0, 0, 0);
  float ridge = least_ridge;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t vertex = seen.vertex[i];
    const VertexPlace place = grid.place_of(vertex);
    const GridFrame& frame = grid.frame_of(place.level);
    d[i] = V3f(place.at) - frame.to_index(p);
    if (seen.weight[i] == 0) continue;
    if (!grid.guard.empty()) d[i] += measured_at(grid.guard[vertex]);
    d[i] = d[i] * frame.spacing_m / unit_m;
    mean += d[i] * seen.weight[i];
    ridge += ridge_of_noise * seen.weight[i] * relative_variance(grid, vertex);
  }
  float xx = ridge;
  float yy = ridge;
  float zz = ridge;
  float xy = 0;
  float xz = 0;
  float yz = 0;
  for (std::size_t i = 0; i < count; ++i) {
    d[i] -= mean;
    const V3f wd = d[i] * seen.weight[i];
    xx += wd.x * d[i].x;
    yy += wd.y * d[i].y;
    zz += wd.z * d[i].z;
    xy += wd.x * d[i].y;
    xz += wd.x * d[i].z;
    yz += wd.y * d[i].z;
  }
  // C^-1 (p - m) by the adjugate; p is the origin.
  const V3f row_x(yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
  const V3f row_y(row_x.y, xx * zz - xz * xz, xy * xz - xx * yz);
  const V3f row_z(row_x.z, row_y.z, xx * yy - xy * xy);
  const float determinant = xx * row_x.x + xy * row_x.y + xz * row_x.z;
  const V3f slope = V3f(row_x.dot(mean), row_y.dot(mean), row_z.dot(mean)) * (-1 / determinant);
  Footprint out = seen;
  for (std::size_t i = 0; i < count; ++i) out.weight[i] *= 1 + slope.dot(d[i]);
  return out;
}

}  // namespace ivory
