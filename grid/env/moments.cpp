#include "grid/env/moments.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace ivory {

namespace {

// --- lat-long ---------------------------------------------------------------------------------------
//
// With polar angle p from +Y and azimuth a, w = (-sin p sin a, cos p, sin p cos a) and dw = sin p dp da. Every product
// of up to two components splits into a factor of p, the same along a row, and one of 1, cos a, sin a, cos 2a, sin 2a.
// So a row needs only five sums S_k = sum of L f_k(a) over its texels (three colours each); integrating f_k exactly
// over a texel's width d multiplies its value at the centre by 2 sin(k d/2) / k.
//
// The loop runs along the row's floats r g b r g b ..., twelve (four texels) at a time, against a table of cos and sin
// for offsets within a block of columns that stays in the first cache; the block's own azimuth is turned in afterwards
// by the addition theorems. Where the width allows, four quarters of the row run side by side: with azimuths x, x + 90,
// x + 180, x + 270 degrees their values L_0 .. L_3 enter as
//   cos x (L_0 - L_2) - sin x (L_1 - L_3),   sin x (L_0 - L_2) + cos x (L_1 - L_3),
//   cos 2x (L_0 - L_1 + L_2 - L_3),          sin 2x (L_0 - L_1 + L_2 - L_3),
// half the arithmetic and a quarter of the table's reads: then memory sets the pace.
constexpr int block_columns = 256;
constexpr int lanes = 12;

struct BlockTable {
  // cos x, sin x, cos 2x, sin 2x of a column's offset from the block's first, once for each of its floats.
  std::array<std::vector<double>, 4> f;
};

BlockTable make_block_table(int width) {
  BlockTable table;
  const int columns = std::min(block_columns, width);
  for (auto& f : table.f) f.resize(std::size_t(3 * columns));
  for (int i = 0; i < 3 * columns; ++i) {
    const int column = i / 3;
    const double x = 2 * std::numbers::pi / width * column;
    table.f[0][std::size_t(i)] = std::cos(x);
    table.f[1][std::size_t(i)] = std::sin(x);
    table.f[2][std::size_t(i)] = std::cos(2 * x);
    table.f[3][std::size_t(i)] = std::sin(2 * x);
  }
  return table;
}

using RowSums = std::array<V3d, 5>;

// Sums over a block of `columns` texels, or of four blocks a quarter of the row apart, by azimuth from the (first)
// block's beginning.
template <int blocks>
RowSums block_sums(const std::array<const float*, blocks>& values, int columns, const BlockTable& table) {
  static_assert(blocks == 1 || blocks == 4);
  const int count = 3 * columns;
  const double* const cos1 = table.f[0].data();
  const double* const sin1 = table.f[1].data();
  const double* const cos2 = table.f[2].data();
  const double* const sin2 = table.f[3].data();
  double s[5][lanes] = {};
  const auto add = [&](int i, int k) {
    const double a = double(values[0][i]);
    if constexpr (blocks == 4) {
      const double b = double(values[1][i]);
      const double c = double(values[2][i]);
      const double d = double(values[3][i]);
      const double ac = a + c;
      const double bd = b + d;
      s[0][k] += ac + bd;
      s[1][k] += (a - c) * cos1[i] - (b - d) * sin1[i];
      s[2][k] += (a - c) * sin1[i] + (b - d) * cos1[i];
      s[3][k] += (ac - bd) * cos2[i];
      s[4][k] += (ac - bd) * sin2[i];
    } else {
      s[0][k] += a;
      s[1][k] += a * cos1[i];
      s[2][k] += a * sin1[i];
      s[3][k] += a * cos2[i];
      s[4][k] += a * sin2[i];
    }
  };
  int i = 0;
  for (; i + lanes <= count; i += lanes)
    for (int k = 0; k < lanes; ++k) add(i + k, k);
  for (int k = 0; i < count; ++i, ++k) add(i, k);
  RowSums sums;
  for (std::size_t f = 0; f < 5; ++f) {
    sums[f] = V3d(0, 0, 0);
    for (int k = 0; k < lanes; ++k) sums[f][k % 3] += s[f][k];
  }
  return sums;
}

// --- quadrature over a texel of a cube's face -----------------------------------------------------------

struct LocalMoments {
  double total = 0;
  V3d first{0, 0, 0};
  std::array<double, 6> second{};  // xx, yy, zz, xy, yz, xz

  void add(const V3d& w, double weight) {
    total += weight;
    first += w * weight;
    second[0] += w.x * w.x * weight;
    second[1] += w.y * w.y * weight;
    second[2] += w.z * w.z * weight;
    second[3] += w.x * w.y * weight;
    second[4] += w.y * w.z * weight;
    second[5] += w.x * w.z * weight;
  }
};

// In the face's axes x = right, y = down, z = forward. dw = ds dt / (1 + s^2 + t^2)^(3/2). Three Gauss points leave a
// relative error of order (h/2)^6 / 2000 times derivatives of order 6! / pole distance^6 ~ h^6 / 200: below 1e-9 for h
// = 1/32, to which larger texels are divided.
LocalMoments cube_local_moments(int size, int row, int column) {
  constexpr std::array<double, 3> point{0.11270166537925831, 0.5, 0.88729833462074169};
  constexpr std::array<double, 3> weight{5.0 / 18, 8.0 / 18, 5.0 / 18};
  const int parts = std::max(1, (64 + size - 1) / size);
  const double h = 2.0 / size / parts;
  LocalMoments out;
  for (int pj = 0; pj < parts; ++pj) {
    for (int pi_ = 0; pi_ < parts; ++pi_) {
      for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < 3; ++i) {
          const double s = cube_edge(size, column) + h * (pi_ + point[i]);
          const double t = cube_edge(size, row) + h * (pj + point[j]);
          const double inverse = 1 / std::sqrt(1 + s * s + t * t);
          out.add(V3d(s, t, 1) * inverse, h * h * weight[i] * weight[j] * inverse * inverse * inverse);
        }
      }
    }
  }
  return out;
}

void add_scaled(RadianceMoments& sum, const LocalMoments& texel, const Rgb& radiance) {
  const V3d value(radiance);
  sum.total += value * texel.total;
  for (std::size_t i = 0; i < 3; ++i) sum.first[i] += value * texel.first[unsigned(i)];
  for (std::size_t i = 0; i < 6; ++i) sum.second[i] += value * texel.second[i];
}

// From a face's axes to the world's.
RadianceMoments turned(const RadianceMoments& local, const CubeFaceAxes& axes) {
  const std::array<V3d, 3> e{V3d(axes.right), V3d(axes.down), V3d(axes.forward)};
  constexpr std::size_t pair[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  RadianceMoments out;
  out.total = local.total;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < 3; ++i) out.first[a] += local.first[i] * e[i][unsigned(a)];
    for (std::size_t b = a; b < 3; ++b) {
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
          out.second[pair[a][b]] += local.second[pair[i][j]] * (e[i][unsigned(a)] * e[j][unsigned(b)]);
      }
    }
  }
  return out;
}

}  // namespace

RadianceMoments& RadianceMoments::operator+=(const RadianceMoments& other) {
  total += other.total;
  for (std::size_t i = 0; i < 3; ++i) first[i] += other.first[i];
  for (std::size_t i = 0; i < 6; ++i) second[i] += other.second[i];
  return *this;
}

RadianceMoments latlong_moments(std::span<const Rgb> texels, int width, int height, int row_begin, int row_end) {
  assert(texels.size() == std::size_t(width) * std::size_t(height) && row_begin >= 0 && row_end <= height);
  const BlockTable table = make_block_table(width);
  const double d = 2 * std::numbers::pi / width;
  const double integral1 = 2 * std::sin(d / 2);
  const double integral2 = std::sin(d);
  RadianceMoments out;
  for (int row = row_begin; row < row_end; ++row) {
    RowSums sums;
    sums.fill(V3d(0, 0, 0));
    const Rgb* const begin = texels.data() + std::size_t(row) * std::size_t(width);
    const int quarter = width / 4;
    const bool quarters = width % 4 == 0;
    const int end = quarters ? quarter : width;
    for (int column = 0; column < end; column += block_columns) {
      const int columns = std::min(block_columns, end - column);
      const Rgb* const first = begin + column;
      const RowSums block =
          quarters ? block_sums<4>({&first->x, &first[quarter].x, &first[2 * quarter].x, &first[3 * quarter].x},
                                   columns, table)
                   : block_sums<1>({&first->x}, columns, table);
      const double a = (column + 0.5) * d - std::numbers::pi;
      const double c1 = std::cos(a);
      const double s1 = std::sin(a);
      const double c2 = std::cos(2 * a);
      const double s2 = std::sin(2 * a);
      sums[0] += block[0];
      sums[1] += block[1] * c1 - block[2] * s1;
      sums[2] += block[1] * s1 + block[2] * c1;
      sums[3] += block[3] * c2 - block[4] * s2;
      sums[4] += block[3] * s2 + block[4] * c2;
    }
    // Integrals over the row's polar angles of sin^(i+1) cos^j.
    const double p0 = row * std::numbers::pi / height;
    const double p1 = (row + 1) * std::numbers::pi / height;
    const double step = std::numbers::pi / height;
    const double middle = (row + 0.5) * step;
    const double sine = 2 * std::sin(middle) * std::sin(step / 2);
    const double sine2 = step / 2 - std::cos(2 * middle) * std::sin(step) / 2;
    const double sine_cosine = std::sin(2 * middle) * std::sin(step) / 2;
    const auto cube = [](double x) { return x * x * x; };
    const double sine_cosine2 = (cube(std::cos(p0)) - cube(std::cos(p1))) / 3;
    const double sine3 = sine - sine_cosine2;
    const double sine2_cosine = (cube(std::sin(p1)) - cube(std::sin(p0))) / 3;
    const V3d all = sums[0] * d;
    const V3d cos1 = sums[1] * integral1;
    const V3d sin1 = sums[2] * integral1;
    const V3d cos2 = sums[3] * integral2;
    const V3d sin2 = sums[4] * integral2;
    out.total += all * sine;
    out.first[0] -= sin1 * sine2;
    out.first[1] += all * sine_cosine;
    out.first[2] += cos1 * sine2;
    out.second[0] += (all - cos2) * (0.5 * sine3);
    out.second[1] += all * sine_cosine2;
    out.second[2] += (all + cos2) * (0.5 * sine3);
    out.second[3] -= sin1 * sine2_cosine;
    out.second[4] += cos1 * sine2_cosine;
    out.second[5] -= sin2 * (0.5 * sine3);
  }
  return out;
}

RadianceMoments cube_moments(const CubeMap& map, int row_begin, int row_end) {
  std::array<RadianceMoments, cube_faces> faces;
  for (int row = row_begin; row < row_end; ++row) {
    for (int column = 0; column < map.size; ++column) {
      const LocalMoments texel = cube_local_moments(map.size, row, column);
      for (int face = 0; face < cube_faces; ++face)
        add_scaled(faces[std::size_t(face)], texel, map.texels[cube_index(map.size, face, row, column)]);
    }
  }
  RadianceMoments out;
  for (int face = 0; face < cube_faces; ++face) out += turned(faces[std::size_t(face)], cube_face_axes(face));
  return out;
}

RadianceMoments angular_moments(const AngularMap& map, int row_begin, int row_end) {
  RadianceMoments out;
  for (int row = row_begin; row < row_end; ++row) {
    for (int column = 0; column < map.size; ++column) {
      LocalMoments texel;
      for (const AngularNode& node : angular_nodes(map.size, row, column)) texel.add(node.w, node.solid_angle);
      add_scaled(out, texel, map.texels[std::size_t(row) * std::size_t(map.size) + std::size_t(column)]);
    }
  }
  return out;
}

LatLongTexels::LatLongTexels(int width, int height) : column_width_(2 * std::numbers::pi / width) {
  const double step = std::numbers::pi / height;
  for (int row = 0; row < height; ++row) {
    const double middle = (row + 0.5) * step;
    rows_.push_back({2 * std::sin(middle) * std::sin(step / 2), step / 2 - std::cos(2 * middle) * std::sin(step) / 2,
                     std::sin(2 * middle) * std::sin(step) / 2});
  }
  const double integral = 2 * std::sin(column_width_ / 2);
  for (int column = 0; column < width; ++column) {
    const double a = (column + 0.5) * column_width_ - std::numbers::pi;
    columns_.push_back({integral * std::cos(a), integral * std::sin(a)});
  }
}

TexelMoments LatLongTexels::operator()(int row, int column) const {
  const auto& [sine, sine2, sine_cosine] = rows_[std::size_t(row)];
  const auto& [c, s] = columns_[std::size_t(column)];
  return {column_width_ * sine, {-sine2 * s, sine_cosine * column_width_, sine2 * c}};
}

TexelMoments cube_texel_moments(int size, int row, int column) {
  const LocalMoments texel = cube_local_moments(size, row, column);
  return {texel.total, texel.first};
}

TexelMoments angular_texel_moments(int size, int row, int column) {
  TexelMoments out;
  for (const AngularNode& node : angular_nodes(size, row, column)) {
    out.solid_angle += node.solid_angle;
    out.first += node.w * node.solid_angle;
  }
  return out;
}

}  // namespace ivory
