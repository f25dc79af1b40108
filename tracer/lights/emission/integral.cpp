#include "tracer/lights/emission/integral.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tracer/core/surface.h"
#include "tracer/core/texture.h"

namespace ivory {

namespace {

// Coordinates at which texels still are told apart by float.
constexpr double most_texels = 4e6;

const Material& material_of(const Scene& scene, int mesh) {
  return scene.materials[std::size_t(scene.meshes[std::size_t(mesh)].material)];
}

// Longest edge of the triangle in texels of a texture.
float extent_texels(const Scene& scene, const Mesh& mesh, int triangle, const TextureUse& use) {
  const Imath::V2i texels = texture_size(scene, use);
  if (texels.x == 0) return 0;
  const V2f size{texels};
  const std::array<V2f, 3> corners{uv_at(mesh, triangle, {0, 0}, use) * size, uv_at(mesh, triangle, {1, 0}, use) * size,
                                   uv_at(mesh, triangle, {0, 1}, use) * size};
  float longest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const V2f edge = corners[(i + 1) % 3] - corners[i];
    longest = std::max({longest, std::abs(edge.x), std::abs(edge.y)});
  }
  return longest;
}

// Exact for products of a bilinear emission, a bilinear alpha and a vertex's: degree 5 (Radon, "Zur mechanischen
// Kubatur", 1948). Weights as shares of the triangle's area.
struct QuadraturePoint {
  double a, b, c, weight;
};
const std::array<QuadraturePoint, 7>& radon_points() {
  static const std::array<QuadraturePoint, 7> points = [] {
    const double root = std::sqrt(15.0);
    const double near = (6 - root) / 21;
    const double far = (6 + root) / 21;
    const double near_weight = (155 - root) / 1200;
    const double far_weight = (155 + root) / 1200;
    return std::array<QuadraturePoint, 7>{{{1.0 / 3, 1.0 / 3, 1.0 / 3, 9.0 / 40},
                                           {near, near, 1 - 2 * near, near_weight},
                                           {near, 1 - 2 * near, near, near_weight},
                                           {1 - 2 * near, near, near, near_weight},
                                           {far, far, 1 - 2 * far, far_weight},
                                           {far, 1 - 2 * far, far, far_weight},
                                           {1 - 2 * far, far, far, far_weight}}};
  }();
  return points;
}

// Integral of value(corner) over a triangle of corners whose sides are halved `cuts` times; of these, those after the
// first `always` only where the value is nothing in some places and something in others: along the edges of a mask.
template <typename Value>
V3d integral(const TexelCorner& a, const TexelCorner& b, const TexelCorner& c, int cuts, int always,
             const Value& value) {
  const auto mix = [&](double wa, double wb, double wc) {
    return TexelCorner{wa * a.b1 + wb * b.b1 + wc * c.b1, wa * a.b2 + wb * b.b2 + wc * c.b2,
                       wa * a.x + wb * b.x + wc * c.x, wa * a.y + wb * b.y + wc * c.y};
  };
  const auto is_mixed = [&] {
    const bool dark = value(mix(1.0 / 3, 1.0 / 3, 1.0 / 3)) == V3d(0, 0, 0);
    return std::ranges::any_of(std::array<const TexelCorner*, 3>{&a, &b, &c},
                               [&](const TexelCorner* at) { return (value(*at) == V3d(0, 0, 0)) != dark; });
  };
  if (cuts > 0 && (always > 0 || is_mixed())) {
    const TexelCorner ab = mix(0.5, 0.5, 0);
    const TexelCorner bc = mix(0, 0.5, 0.5);
    const TexelCorner ca = mix(0.5, 0, 0.5);
    const int left = cuts - 1;
    return integral(a, ab, ca, left, always - 1, value) + integral(ab, b, bc, left, always - 1, value) +
           integral(ca, bc, c, left, always - 1, value) + integral(ab, bc, ca, left, always - 1, value);
  }
  V3d sum(0, 0, 0);
  for (const QuadraturePoint& q : radon_points()) sum += value(mix(q.a, q.b, q.c)) * q.weight;
  return sum * area_of(a, b, c);
}

template <typename Value>
V3d integral(const TexelPolygon& polygon, int cuts, int always, const Value& value) {
  V3d sum(0, 0, 0);
  for (std::size_t k = 2; k < polygon.count; ++k)
    sum += integral(polygon.corners[0], polygon.corners[k - 1], polygon.corners[k], cuts, always, value);
  return sum;
}

TexelPolygon cell_polygon(const EmissionMap& map, const TexelPolygon& polygon, int i, int j) {
  return clipped_to_cell(clipped_to_cell(polygon, map.y, &TexelCorner::y, j), map.x, &TexelCorner::x, i);
}

}  // namespace

Rgb covered_emission_at(const Scene& scene, int mesh, int triangle, const V2f& barycentric) {
  const Rgb emission = emission_at(scene, mesh, triangle, barycentric);
  if (material_of(scene, mesh).alpha_mode == AlphaMode::opaque) return emission;
  return emission * coverage_at(scene, mesh, triangle, barycentric);
}

Rgb sampled_mean(const Scene& scene, int mesh_index, int triangle, int most_steps) {
  const Mesh& mesh = scene.meshes[std::size_t(mesh_index)];
  const Material& material = material_of(scene, mesh_index);
  float extent = extent_texels(scene, mesh, triangle, material.emission_texture);
  if (material.alpha_mode != AlphaMode::opaque) {
    extent = std::max(extent, extent_texels(scene, mesh, triangle, material.base_color_texture));
    if (!mesh.colors.empty()) extent = std::max(extent, 8.0F);
  }
  const int n = int(std::clamp(std::ceil(extent), 1.0F, float(most_steps)));
  double sum[3] = {0, 0, 0};
  const auto add = [&](float i, float j) {
    const Rgb radiance = covered_emission_at(scene, mesh_index, triangle, V2f(i, j) / float(n));
    for (int c = 0; c < 3; ++c) sum[c] += double(radiance[c]);
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n - i; ++j) {
      add(float(i) + 1.0F / 3, float(j) + 1.0F / 3);
      if (j < n - i - 1) add(float(i) + 2.0F / 3, float(j) + 2.0F / 3);
    }
  }
  const double count = double(n) * n;
  Rgb mean(float(sum[0] / count), float(sum[1] / count), float(sum[2] / count));
  // A corner alone may shine, between the points.
  if (is_black(mean) && n > 1) {
    const float share = 1 / float(n * n);
    for (const V2f& b : {V2f(0, 0), V2f(1, 0), V2f(0, 1)})
      mean += covered_emission_at(scene, mesh_index, triangle, b) * (share / 3);
  }
  return mean;
}

TexelPolygon polygon_of(const EmissionMap& map, const Mesh& mesh, int triangle) {
  TexelPolygon polygon;
  for (const V2f& b : {V2f(0, 0), V2f(1, 0), V2f(0, 1)}) {
    const V2f uv = uv_at(mesh, triangle, b, map.use);
    const double x = double(uv.x) * map.texels.x;
    const double y = double(uv.y) * map.texels.y;
    if (!(std::abs(x) <= most_texels && std::abs(y) <= most_texels)) return {};
    polygon.corners[polygon.count++] = {double(b.x), double(b.y), map.x.at(x), map.y.at(y)};
  }
  return polygon;
}

double cell_area(const TexelPolygon& triangle) {
  const auto& [a, b, c] = std::array<TexelCorner, 3>{triangle.corners[0], triangle.corners[1], triangle.corners[2]};
  return 1 / std::abs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
}

EmissionIntegrator::EmissionIntegrator(const Scene& scene, int mesh, const EmissionMap& map)
    : scene_(scene),
      mesh_(mesh),
      map_(map),
      material_(material_of(scene, mesh)),
      opaque_(material_.alpha_mode == AlphaMode::opaque),
      by_cell_(opaque_ || (map.whole && scene.meshes[std::size_t(mesh)].colors.empty())),
      joined_(map.x.cells_a_texel != 1 || map.y.cells_a_texel != 1),
      same_size_(texture_size(scene, material_.base_color_texture) == map.texels) {}

EmissionIntegrator::Row EmissionIntegrator::row(const TexelPolygon& polygon, double whole_cell, int triangle,
                                                int j) const {
  Row sum{0, V3d(0, 0, 0)};
  visit_row(
      polygon, map_.x, map_.y, j,
      [&](int begin, int end) {
        const double run = run_weight(map_, begin, end, j);
        if (!(run > 0)) return;
        sum.weight += run * whole_cell;
        if (by_cell_) {
          sum.light += run_radiance(map_, begin, end, j) * whole_cell;
        } else {
          for (int i = begin; i < end; ++i)
            if (cell_weight(map_, i, j) > 0) sum.light += piece(cell_polygon(map_, polygon, i, j), triangle, i, j);
        }
      },
      [&](int i, const TexelPolygon& part) {
        const double here = cell_weight(map_, i, j);
        if (!(here > 0)) return;
        sum.weight += here * area_of(part);
        sum.light += piece(part, triangle, i, j);
      });
  return sum;
}

// What the triangle covers of a cell.
V3d EmissionIntegrator::piece(const TexelPolygon& part, int triangle, int i, int j) const {
  const bool nearest = scene_.textures[std::size_t(map_.use.texture)].nearest;
  if (opaque_ && !joined_ && !nearest) {
    // Twice linear: exact by the middles of the sides.
    V3d light(0, 0, 0);
    for (std::size_t k = 2; k < part.count; ++k) {
      const std::array<const TexelCorner*, 3> corners{&part.corners[0], &part.corners[k - 1], &part.corners[k]};
      V3d sum(0, 0, 0);
      for (std::size_t c = 0; c < 3; ++c) {
        const TexelCorner& from = *corners[c];
        const TexelCorner& to = *corners[(c + 1) % 3];
        sum += bilinear_radiance(map_, i, j, (from.x + to.x) / 2, (from.y + to.y) / 2);
      }
      light += sum * (area_of(*corners[0], *corners[1], *corners[2]) / 3);
    }
    return light;
  }
  if (by_cell_ && (joined_ || opaque_)) return cell_radiance(map_, i, j) * area_of(part);
  // A cut-off makes steps, another texture kinks.
  const bool mask = material_.alpha_mode == AlphaMode::mask;
  const int always = mask ? 1 : joined_ ? 3 : same_size_ ? 0 : 1;
  return integral(part, mask ? 4 : always, always, [&](const TexelCorner& at) {
    const Rgb l = covered_emission_at(scene_, mesh_, triangle, V2f(float(at.b1), float(at.b2)));
    return V3d(double(l.x), double(l.y), double(l.z));
  });
}

}  // namespace ivory
