#include "grid/env/irradiance/sum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <tbb/parallel_for.h>

#include "grid/env/moments.h"

// E(n) = sum over texels of L  integral over the texel of max(0, n.w) dw.
//
// Of a texel above the horizon this is n.V with V = integral of w; below it is 0: max(0, n.V) for both. In a part of a
// texel that the horizon cuts x = n.w lies within [a - s, a + s] around its mean a, and max(0, a) is at most s/2 too
// little (the gap between a convex function and its chord, largest at a = 0).

namespace ivory {

namespace {

// A map's texels, each divided into k by k; cube maps as six faces below each other.
class Texels {
 public:
  Texels(const EnvironmentImage& image, int k) : image_(&image), k_(k) {
    if (const auto* map = std::get_if<EnvironmentMap>(&image.map)) {
      rows_ = map->height * k;
      columns_ = map->width * k;
      latlong_.emplace(columns_, rows_);
    } else if (const auto* cube = std::get_if<CubeMap>(&image.map)) {
      rows_ = cube_faces * cube->size * k;
      columns_ = cube->size * k;
    } else {
      rows_ = columns_ = std::get<AngularMap>(image.map).size * k;
    }
  }

  int rows() const { return rows_; }
  int columns() const { return columns_; }

  TexelMoments moments(int row, int column) const {
    if (latlong_) return (*latlong_)(row, column);
    if (!std::holds_alternative<CubeMap>(image_->map)) return angular_texel_moments(columns_, row, column);
    TexelMoments m = cube_texel_moments(columns_, row % columns_, column);
    const CubeFaceAxes& axes = cube_face_axes(row / columns_);
    m.first = V3d(axes.right) * m.first.x + V3d(axes.down) * m.first.y + V3d(axes.forward) * m.first.z;
    return m;
  }

  Rgb radiance(int row, int column) const {
    const std::size_t i = std::size_t(row / k_) * std::size_t(columns_ / k_) + std::size_t(column / k_);
    return std::visit(
        [&](const auto& map) -> Rgb {
          if constexpr (std::is_same_v<std::decay_t<decltype(map)>, EnvironmentMap>) {
            return map.radiance[i];
          } else {
            return map.texels[i];
          }
        },
        image_->map);
  }

 private:
  const EnvironmentImage* image_;
  int k_;
  int rows_ = 0;
  int columns_ = 0;
  std::optional<LatLongTexels> latlong_;
};

// Directions of a texel lie within this of their mean, as a chord: three times their root mean square distance from it,
// which 2 (1 - |mean|) is the square of. A rectangle's corner lies 1.7 of those from its centre, a triangle's 2.8.
double reach(const TexelMoments& m) {
  return 3 * std::sqrt(std::max(0.0, 2 * (1 - m.first.length() / m.solid_angle))) + 1e-7;
}

// The rows that a map has from pole to pole.
int rows_of_sphere(const EnvironmentImage& image) {
  const Texels whole(image, 1);
  return std::holds_alternative<CubeMap>(image.map) ? 2 * whole.columns() : whole.rows();
}

constexpr int parts_across = 4;  // that a texel, and a part of one, is divided into

// A texel, or a part of one.
struct Part {
  V3d first;
  double limit = 0;  // of first.n for the horizon to cut it
  int level = 0;     // each divides the one before
  int row = 0, column = 0;
  std::size_t parts = 0;  // where the first of its own stands; 0 before they are asked for
};

Part make_part(const std::vector<Texels>& levels, int level, int row, int column) {
  const TexelMoments m = levels[std::size_t(level)].moments(row, column);
  if (!(m.solid_angle > 0)) return {V3d(0, 0, 0), 0, level, row, column};
  return {m.first, m.solid_angle * reach(m), level, row, column};
}

// What a normal gets of radiance 1, and what that may be wrong by.
struct Gain {
  double e = 0;
  double off = 0;
};

// Of the part at index i of a tree that grows where horizons cut it.
Gain gain_of(std::vector<Part>& tree, std::size_t i, const std::vector<Texels>& levels, const V3d& n) {
  const double x = tree[i].first.dot(n);
  if (std::abs(x) >= tree[i].limit) return {std::max(0.0, x), 0};
  if (tree[i].level + 1 == int(levels.size())) return {std::max(0.0, x), 0.5 * tree[i].limit};
  if (tree[i].parts == 0) {
    const Part whole = tree[i];
    tree[i].parts = tree.size();
    for (int part = 0; part < parts_across * parts_across; ++part) {
      tree.push_back(make_part(levels, whole.level + 1, whole.row * parts_across + part / parts_across,
                               whole.column * parts_across + part % parts_across));
    }
  }
  Gain sum;
  for (std::size_t part = tree[i].parts, end = part + parts_across * parts_across; part < end; ++part) {
    const Gain gain = gain_of(tree, part, levels, n);
    sum.e += gain.e;
    sum.off += gain.off;
  }
  return sum;
}

struct Normals {
  std::vector<double> x, y, z;
};

struct Sums {
  std::vector<double> r, g, b;              // of each normal
  std::vector<double> r_off, g_off, b_off;  // what they may be wrong by
};

void add_row(const std::vector<Texels>& levels, int row, const Normals& n, Sums& sums) {
  const std::size_t count = n.x.size();
  std::vector<double> x(count);
  std::vector<Part> tree;
  for (int column = 0; column < levels.front().columns(); ++column) {
    const Rgb radiance = levels.front().radiance(row, column);
    const Part texel = make_part(levels, 0, row, column);
    if (is_black(radiance) || !(texel.limit > 0)) continue;
    const V3d l(radiance);
    for (std::size_t i = 0; i < count; ++i) {
      x[i] = texel.first.x * n.x[i] + texel.first.y * n.y[i] + texel.first.z * n.z[i];
      const double above = 0.5 * (x[i] + std::abs(x[i]));  // max(0, x) to the bit, without a branch
      sums.r[i] += l.x * above;
      sums.g[i] += l.y * above;
      sums.b[i] += l.z * above;
    }
    tree.assign(1, texel);
    for (std::size_t i = 0; i < count; ++i) {
      if (std::abs(x[i]) >= texel.limit) continue;
      const Gain gain = gain_of(tree, 0, levels, {n.x[i], n.y[i], n.z[i]});
      const double more = gain.e - std::max(0.0, x[i]);
      sums.r[i] += l.x * more;
      sums.g[i] += l.y * more;
      sums.b[i] += l.z * more;
      sums.r_off[i] += l.x * gain.off;
      sums.g_off[i] += l.y * gain.off;
      sums.b_off[i] += l.z * gain.off;
    }
  }
}

}  // namespace

IrradianceSums sum_irradiance(const EnvironmentImage& image, std::span<const V3f> normals) {
  constexpr std::size_t block = 4096;  // normals at a time, for memory
  constexpr int chunks = 64;           // of rows, whatever the number of threads
  std::vector<Texels> levels;
  for (int k = 1, rows = rows_of_sphere(image); k <= 4 || (k <= 64 && k / parts_across * rows < 4096);
       k *= parts_across)
    levels.emplace_back(image, k);
  IrradianceSums out;
  for (std::size_t first = 0; first < normals.size(); first += block) {
    const std::size_t count = std::min(block, normals.size() - first);
    Normals n;
    for (const V3f& normal : normals.subspan(first, count)) {
      n.x.push_back(double(normal.x));
      n.y.push_back(double(normal.y));
      n.z.push_back(double(normal.z));
    }
    const std::vector<double> zeros(count, 0.0);
    std::vector<Sums> sums(chunks);
    tbb::parallel_for(0, chunks, [&](int chunk) {
      const auto edge = [&](int i) { return int(std::int64_t(levels.front().rows()) * i / chunks); };
      Sums& own = sums[std::size_t(chunk)] = {zeros, zeros, zeros, zeros, zeros, zeros};
      for (int row = edge(chunk); row < edge(chunk + 1); ++row) add_row(levels, row, n, own);
    });
    for (std::size_t i = 0; i < count; ++i) {
      V3d e(0, 0, 0);
      V3d off(0, 0, 0);
      for (const Sums& part : sums) {
        e += V3d(part.r[i], part.g[i], part.b[i]);
        off += V3d(part.r_off[i], part.g_off[i], part.b_off[i]);
      }
      out.e.push_back(e);
      for (int c = 0; c < 3; ++c) out.error_bound[c] = std::max(out.error_bound[c], off[c]);
    }
  }
  return out;
}

}  // namespace ivory
