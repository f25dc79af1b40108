#include "grid/cubemap/captured.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

// Over a triangle of the shell inverse depth is linear in the point q of the cube: with the barycentric weights b_k of
// q among the triangle's corners, v(q) = sum b_k v_k. Fitting the shell to the captured inverse distances 1/d = v / |q|
// is therefore a linear problem,
//
//   minimise  sum over captured texels of  dw (sum b_k v_k - |q| / d)^2 / |q|^2,
//
// with the solid angle dw as weight. Errors of 1/d are what a receiver near the surface suffers from, and what the sky,
// 1/d = 0, has a finite one of. Each v_k touches its neighbours alone, and the matrix is that of a mesh's masses:
// conjugate gradients converge in a few dozen steps at any size.

namespace ivory {

namespace {

// A triangle's part of the normal equations: entries (0,0), (0,1), (0,2), (1,1), (1,2), (2,2).
struct Triangle {
  std::array<std::uint32_t, 3> vertices{};
  std::array<double, 6> matrix{};
};

struct System {
  std::vector<Triangle> triangles;
  std::vector<double> diagonal;  // added to all
  std::vector<double> right;
};

std::vector<double> multiply(const System& system, const std::vector<double>& x) {
  std::vector<double> y(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = system.diagonal[i] * x[i];
  for (const Triangle& t : system.triangles) {
    const auto& [a, b, c] = t.vertices;
    y[a] += t.matrix[0] * x[a] + t.matrix[1] * x[b] + t.matrix[2] * x[c];
    y[b] += t.matrix[1] * x[a] + t.matrix[3] * x[b] + t.matrix[4] * x[c];
    y[c] += t.matrix[2] * x[a] + t.matrix[4] * x[b] + t.matrix[5] * x[c];
  }
  return y;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// Conjugate gradients from x on.
void solve(const System& system, std::vector<double>& x) {
  constexpr int most_steps = 200;
  std::vector<double> residual = multiply(system, x);
  for (std::size_t i = 0; i < x.size(); ++i) residual[i] = system.right[i] - residual[i];
  std::vector<double> direction = residual;
  double squared = dot(residual, residual);
  const double enough = 1e-20 * dot(system.right, system.right);
  for (int step = 0; step < most_steps && squared > enough; ++step) {
    const std::vector<double> image = multiply(system, direction);
    const double length = squared / dot(direction, image);
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] += length * direction[i];
      residual[i] -= length * image[i];
    }
    const double next = dot(residual, residual);
    for (std::size_t i = 0; i < x.size(); ++i) direction[i] = residual[i] + next / squared * direction[i];
    squared = next;
  }
}

// Where the captured texels lie among the large ones.
struct Layout {
  int fine;
  int coarse;
  int ratio;
  std::vector<std::uint32_t> vertices;  // corner_vertices(coarse)
  std::size_t vertex_count;

  explicit Layout(int fine_size, int coarse_size)
      : fine(fine_size),
        coarse(coarse_size),
        ratio(fine_size / coarse_size),
        vertices(corner_vertices(coarse_size)),
        vertex_count(6 * std::size_t(coarse_size) * std::size_t(coarse_size) + 2) {}

  // Of a captured texel's centre.
  V3d point(int face, int row, int column) const {
    return cube_point(face, double(2 * column + 1 - fine) / fine, double(2 * row + 1 - fine) / fine);
  }
};

template <typename Function>
void for_each_texel(int size, const Function& function) {
  std::size_t i = 0;
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column, ++i) function(i, face, row, column);
    }
  }
}

double inverse_depth(const CapturedCube& captured, const Layout& layout, std::size_t i, int face, int row, int column) {
  return double(captured.inverse_distance[i]) * layout.point(face, row, column).length();
}

// The mean inverse depth of the captured texels that touch a vertex: four, or three at a corner of the cube. Exact for
// a plane, but for what lies across a seam.
std::vector<double> at_corners(const CapturedCube& captured, const Layout& layout) {
  std::vector<double> sum(layout.vertex_count, 0.0);
  std::vector<int> count(layout.vertex_count, 0);
  for_each_texel(layout.coarse, [&](std::size_t i, int face, int row, int column) {
    for (int k = 0; k < 4; ++k) {
      const int fine_row = row * layout.ratio + (k / 2 == 0 ? 0 : layout.ratio - 1);
      const int fine_column = column * layout.ratio + (k % 2 == 0 ? 0 : layout.ratio - 1);
      const std::uint32_t vertex = layout.vertices[4 * i + std::size_t(k)];
      sum[vertex] += inverse_depth(captured, layout, cube_index(layout.fine, face, fine_row, fine_column), face,
                                   fine_row, fine_column);
      ++count[vertex];
    }
  });
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] /= count[i];
  return sum;
}

std::vector<double> averaged(const CapturedCube& captured, const Layout& layout) {
  const std::size_t texels = layout.vertices.size() / 4;
  std::vector<double> distance(texels, 0.0);
  for_each_texel(layout.fine, [&](std::size_t i, int face, int row, int column) {
    // Inverse depths below are of a mean of distances; the sky makes the mean endless.
    distance[cube_index(layout.coarse, face, row / layout.ratio, column / layout.ratio)] +=
        1 / double(captured.inverse_distance[i]) / double(layout.ratio) / double(layout.ratio);
  });
  std::vector<double> sum(layout.vertex_count, 0.0);
  std::vector<int> count(layout.vertex_count, 0);
  std::vector<double> length(layout.vertex_count, 0.0);
  for_each_texel(layout.coarse, [&](std::size_t i, int face, int row, int column) {
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t vertex = layout.vertices[4 * i + std::size_t(k)];
      sum[vertex] += distance[i];
      ++count[vertex];
      length[vertex] =
          cube_point(face, cube_edge(layout.coarse, column + k % 2), cube_edge(layout.coarse, row + k / 2)).length();
    }
  });
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = length[i] * count[i] / sum[i];
  return sum;
}

std::vector<double> fitted(const CapturedCube& captured, const Layout& layout) {
  System system;
  system.triangles.resize(layout.vertices.size() / 2);
  system.right.assign(layout.vertex_count, 0.0);
  for_each_texel(layout.coarse, [&](std::size_t i, int, int, int) {
    const std::uint32_t* v = &layout.vertices[4 * i];
    system.triangles[2 * i].vertices = {v[0], v[1], v[3]};
    system.triangles[2 * i + 1].vertices = {v[0], v[3], v[2]};
  });
  for_each_texel(layout.fine, [&](std::size_t i, int face, int row, int column) {
    const double right = (column % layout.ratio + 0.5) / layout.ratio;
    const double down = (row % layout.ratio + 0.5) / layout.ratio;
    const std::size_t texel = cube_index(layout.coarse, face, row / layout.ratio, column / layout.ratio);
    const bool first = right > down;
    Triangle& triangle = system.triangles[2 * texel + (first ? 0 : 1)];
    const std::array<double, 3> b = first ? std::array<double, 3>{1 - right, right - down, down}
                                          : std::array<double, 3>{1 - down, right, down - right};
    const double q2 = layout.point(face, row, column).length2();
    const double weight = cube_texel_solid_angle(layout.fine, row, column) / q2;
    const double v = double(captured.inverse_distance[i]) * std::sqrt(q2);
    triangle.matrix[0] += weight * b[0] * b[0];
    triangle.matrix[1] += weight * b[0] * b[1];
    triangle.matrix[2] += weight * b[0] * b[2];
    triangle.matrix[3] += weight * b[1] * b[1];
    triangle.matrix[4] += weight * b[1] * b[2];
    triangle.matrix[5] += weight * b[2] * b[2];
    for (std::size_t k = 0; k < 3; ++k) system.right[triangle.vertices[k]] += weight * b[k] * v;
  });
  // A weak pull towards the distance at the vertex itself decides where few captured texels say anything.
  const std::vector<double> start = at_corners(captured, layout);
  constexpr double pull = 1e-3;
  const double weight = pull * 4 * 3.14159265358979 / double(layout.vertex_count);
  system.diagonal.assign(layout.vertex_count, weight);
  for (std::size_t i = 0; i < start.size(); ++i) system.right[i] += weight * start[i];
  std::vector<double> solution = start;
  solve(system, solution);
  // Least squares overshoots where depth jumps, but not beyond the sky.
  for (double& v : solution) v = std::max(v, 0.0);
  return solution;
}

}  // namespace

LocalizedCube localize(const CapturedCube& captured, int size, ShellFit fit) {
  const int fine = captured.radiance.size;
  assert(size >= 1 && fine >= size && fine % size == 0);
  assert(captured.inverse_distance.size() == captured.radiance.texels.size());
  const Layout layout(fine, size);

  LocalizedCube cube;
  cube.origin_m = captured.origin_m;
  cube.anchor_m = captured.anchor_m;
  cube.radiance.size = size;
  const std::size_t texels = layout.vertices.size() / 4;
  std::vector<std::array<double, 4>> sums(texels);  // R, G, B, solid angle
  for_each_texel(fine, [&](std::size_t i, int face, int row, int column) {
    std::array<double, 4>& sum = sums[cube_index(size, face, row / layout.ratio, column / layout.ratio)];
    const double weight = cube_texel_solid_angle(fine, row, column);
    for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += weight * double(captured.radiance.texels[i][c]);
    sum[3] += weight;
  });
  for (const std::array<double, 4>& sum : sums)
    cube.radiance.texels.emplace_back(float(sum[0] / sum[3]), float(sum[1] / sum[3]), float(sum[2] / sum[3]));

  const std::vector<double> depths = fit == ShellFit::fitted    ? fitted(captured, layout)
                                     : fit == ShellFit::corners ? at_corners(captured, layout)
                                                                : averaged(captured, layout);
  cube.corners.resize(texels);
  for (std::size_t i = 0; i < layout.vertices.size(); ++i)
    cube.corners[i / 4][i % 4] = float(std::min(depths[layout.vertices[i]], 1 / double(least_depth_m)));
  return cube;
}

}  // namespace ivory
