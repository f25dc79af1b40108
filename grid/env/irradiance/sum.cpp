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
          if constexpr (std::is_same_v<std::decay_t<decltype(map)>, EnvironmentMap>)
            return map.radiance[i];
          else
            return map.texels[i];
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

struct Part {
  V3d first;
  double limit;  // of first.n for the horizon to cut it
};

struct Normals {
  std::vector<double> x, y, z;
};

struct Sums {
  std::vector<double> r, g, b;              // of each normal
  std::vector<double> r_off, g_off, b_off;  // what they may be wrong by
};

void add_row(const Texels& whole, const Texels& parts, int k, int row, const Normals& n, Sums& sums) {
  const std::size_t count = n.x.size();
  std::vector<double> x(count);
  std::vector<Part> divided;
  for (int column = 0; column < whole.columns(); ++column) {
    const Rgb radiance = whole.radiance(row, column);
    const TexelMoments m = whole.moments(row, column);
    if (is_black(radiance) || !(m.solid_angle > 0)) continue;
    const V3d l(radiance);
    for (std::size_t i = 0; i < count; ++i) {
      x[i] = m.first.x * n.x[i] + m.first.y * n.y[i] + m.first.z * n.z[i];
      const double above = 0.5 * (x[i] + std::abs(x[i]));  // max(0, x) to the bit, without a branch
      sums.r[i] += l.x * above;
      sums.g[i] += l.y * above;
      sums.b[i] += l.z * above;
    }
    const double limit = m.solid_angle * reach(m);
    divided.clear();
    for (std::size_t i = 0; i < count; ++i) {
      if (std::abs(x[i]) >= limit) continue;
      if (divided.empty()) {
        for (int part = 0; part < k * k; ++part) {
          const TexelMoments p = parts.moments(row * k + part / k, column * k + part % k);
          if (p.solid_angle > 0) divided.push_back({p.first, p.solid_angle * reach(p)});
        }
      }
      double e = 0;
      double off = 0;
      for (const Part& p : divided) {
        const double xp = p.first.x * n.x[i] + p.first.y * n.y[i] + p.first.z * n.z[i];
        e += std::max(0.0, xp);
        off += std::abs(xp) < p.limit ? 0.5 * p.limit : 0.0;
      }
      const double more = e - std::max(0.0, x[i]);
      sums.r[i] += l.x * more;
      sums.g[i] += l.y * more;
      sums.b[i] += l.z * more;
      sums.r_off[i] += l.x * off;
      sums.g_off[i] += l.y * off;
      sums.b_off[i] += l.z * off;
    }
  }
}

}  // namespace

IrradianceSums sum_irradiance(const EnvironmentImage& image, std::span<const V3f> normals) {
  constexpr std::size_t block = 4096;  // normals at a time, for memory
  constexpr int chunks = 64;           // of rows, whatever the number of threads
  const int sphere_rows = rows_of_sphere(image);
  const int k = std::clamp((4096 + sphere_rows - 1) / sphere_rows, 4, 64);
  const Texels whole(image, 1);
  const Texels parts(image, k);
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
      const auto edge = [&](int i) { return int(std::int64_t(whole.rows()) * i / chunks); };
      Sums& own = sums[std::size_t(chunk)] = {zeros, zeros, zeros, zeros, zeros, zeros};
      for (int row = edge(chunk); row < edge(chunk + 1); ++row) add_row(whole, parts, k, row, n, own);
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
