#include "tracer/lights/mesh_emission.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "grid/base/memory.h"
#include "tracer/core/sampling.h"
#include "tracer/core/surface.h"
#include "tracer/core/texture.h"
#include "tracer/lights/texel_polygon.h"

namespace ivory {

namespace {

// Rows and columns of cells that the triangles of a mesh may span in all: a second of one thread, and half a dozen
// microseconds a triangle.
constexpr double most_work = 0x1p21;
constexpr double most_work_a_triangle = 24;
// Lit cells under coverage that is not a function of the cell, each integrated by itself.
constexpr double most_cells = 0x1p22;
constexpr std::size_t most_sums = std::size_t(1) << 20U;
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

// By the centroid rule over n^2 equal triangles, their edges no longer than a texel where n allows: for what has no
// texture (vertex colours may cover it), and for what is too far out for texels to be told apart.
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

// The triangle in cells; empty where its coordinates are not finite or too far out.
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

// Barycentric area of a cell that the triangle covers whole.
double cell_area(const TexelPolygon& triangle) {
  const auto& [a, b, c] = std::array<TexelCorner, 3>{triangle.corners[0], triangle.corners[1], triangle.corners[2]};
  return 1 / std::abs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
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

// Light and sampling weight of triangles by the map.
class Integrator {
 public:
  Integrator(const Scene& scene, int mesh, const EmissionMap& map)
      : scene_(scene), mesh_(mesh), map_(map), material_(material_of(scene, mesh)) {
    opaque_ = material_.alpha_mode == AlphaMode::opaque;
    by_cell_ = opaque_ || (map.whole && scene.meshes[std::size_t(mesh)].colors.empty());
    same_size_ = texture_size(scene, material_.base_color_texture) == map.texels;
    joined_ = map.x.cells_a_texel != 1 || map.y.cells_a_texel != 1;
  }

  // Of one row; `light` (nits times barycentric area) is added to.
  double row(const TexelPolygon& polygon, double whole_cell, int triangle, int j, V3d& light) const {
    double weight = 0;
    visit_row(
        polygon, map_.x, map_.y, j,
        [&](int begin, int end) {
          const double run = run_weight(map_, begin, end, j);
          if (!(run > 0)) return;
          weight += run * whole_cell;
          if (by_cell_) {
            light += run_radiance(map_, begin, end, j) * whole_cell;
          } else {
            for (int i = begin; i < end; ++i)
              if (cell_weight(map_, i, j) > 0) light += piece(cell_polygon(polygon, i, j), triangle, i, j);
          }
        },
        [&](int i, const TexelPolygon& part) {
          const double here = cell_weight(map_, i, j);
          if (!(here > 0)) return;
          weight += here * area_of(part);
          light += piece(part, triangle, i, j);
        });
    return weight;
  }

 private:
  TexelPolygon cell_polygon(const TexelPolygon& polygon, int i, int j) const {
    return clipped_to_cell(clipped_to_cell(polygon, map_.y, &TexelCorner::y, j), map_.x, &TexelCorner::x, i);
  }

  // Light of what the triangle covers of a cell.
  V3d piece(const TexelPolygon& part, int triangle, int i, int j) const {
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

  const Scene& scene_;
  int mesh_;
  const EmissionMap& map_;
  const Material& material_;
  bool opaque_;
  bool by_cell_;
  bool joined_;
  bool same_size_;  // alpha is bilinear in a cell, too
};

int steps_for(const Mesh& mesh) {
  constexpr double evaluations = 1.6e7;  // about a second in all
  return int(std::clamp(std::sqrt(evaluations / double(std::max<std::size_t>(1, mesh.triangles.size()))), 4.0, 512.0));
}

// How many cells must be joined along each axis for the mesh to be integrated in a few seconds.
int cells_to_join(const Scene& scene, int mesh_index, const EmissionMap& axes) {
  const Mesh& mesh = scene.meshes[std::size_t(mesh_index)];
  const bool each_cell =
      material_of(scene, mesh_index).alpha_mode != AlphaMode::opaque && !(axes.whole && mesh.colors.empty());
  double outline = 0;
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const TexelPolygon polygon = polygon_of(axes, mesh, int(t));
    if (polygon.empty()) continue;
    const auto across = cells_of(polygon, axes.x, &TexelCorner::x);
    const auto down = cells_of(polygon, axes.y, &TexelCorner::y);
    const double columns = double(across[1]) - across[0] + 1;
    const double rows = double(down[1]) - down[0] + 1;
    outline += columns + rows;
    area += columns * rows / 2;
  }
  int join = 1;
  const double most = most_work + most_work_a_triangle * double(mesh.triangles.size());
  while (outline / join > most || (each_cell && area / join / join > most_cells)) join *= 2;
  return join;
}

void integrate(const Scene& scene, MeshEmission& emission) {
  const Mesh& mesh = scene.meshes[std::size_t(emission.mesh)];
  const EmissionMap& map = *emission.map;
  const Integrator integrator(scene, emission.mesh, map);
  const std::size_t triangles = mesh.triangles.size();

  std::vector<std::uint64_t> rows(triangles, 0);
  std::uint64_t all_rows = 0;
  for (std::size_t t = 0; t < triangles; ++t) {
    const TexelPolygon polygon = polygon_of(map, mesh, int(t));
    if (polygon.empty()) continue;
    const auto down = cells_of(polygon, map.y, &TexelCorner::y);
    rows[t] = std::uint64_t(down[1] - down[0]) + 1;
    all_rows += rows[t];
  }
  emission.rows_a_sum = int(all_rows / most_sums) + 1;
  emission.first_sum.assign(triangles + 1, 0);
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto stride = std::uint64_t(emission.rows_a_sum);
    emission.first_sum[t + 1] = emission.first_sum[t] + std::uint32_t((rows[t] + stride - 1) / stride);
  }
  emission.row_sums.assign(emission.first_sum.back(), 0);

  const int steps = steps_for(mesh);
  Rgb mean_of_map(0, 0, 0);
  if (std::ranges::find(rows, std::uint64_t(0)) != rows.end()) {
    V3d sum(0, 0, 0);
    for (int j = 0; j < map.y.count; ++j) sum += run_radiance(map, 0, map.x.count, j);
    mean_of_map = Rgb(sum / (double(map.x.count) * map.y.count));
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t t = range.begin(); t < range.end(); ++t) {
      const TexelPolygon polygon = polygon_of(map, mesh, int(t));
      if (polygon.empty()) {
        emission.mean_radiance[t] = sampled_mean(scene, emission.mesh, int(t), steps);
        // What is so far out repeats the texture, or is the same all over.
        if (is_black(emission.mean_radiance[t])) emission.mean_radiance[t] = mean_of_map;
        continue;
      }
      const double whole_cell = cell_area(polygon);
      const auto down = cells_of(polygon, map.y, &TexelCorner::y);
      V3d light(0, 0, 0);
      double weight = 0;
      for (int j = down[0]; j <= down[1]; ++j) {
        weight += integrator.row(polygon, whole_cell, int(t), j, light);
        emission.row_sums[emission.first_sum[t] + std::size_t((j - down[0]) / emission.rows_a_sum)] = weight;
      }
      constexpr double area = 0.5;  // of barycentric coordinates
      // Rounding must not put out what shines.
      for (unsigned c = 0; c < 3; ++c)
        emission.mean_radiance[t][c] = std::max(float(light[c] / area), light[c] > 0 ? 1e-37F : 0.0F);
    }
  });
}

// A uniform point of a convex polygon.
V2f point_in(const TexelPolygon& polygon, float u_part, const V2f& u) {
  double target = double(u_part) * area_of(polygon);
  std::size_t k = 2;
  for (; k + 1 < polygon.count; ++k) {
    const double area = area_of(polygon.corners[0], polygon.corners[k - 1], polygon.corners[k]);
    if (target < area) break;
    target -= area;
  }
  const TexelCorner& a = polygon.corners[0];
  const TexelCorner& b = polygon.corners[k - 1];
  const TexelCorner& c = polygon.corners[k];
  const V2f at = sample_triangle(u);
  const double wb = double(at.x);
  const double wc = double(at.y);
  const double b1 = std::clamp(a.b1 + (b.b1 - a.b1) * wb + (c.b1 - a.b1) * wc, 0.0, 1.0);
  const double b2 = std::clamp(a.b2 + (b.b2 - a.b2) * wb + (c.b2 - a.b2) * wc, 0.0, 1.0 - b1);
  return {float(b1), float(b2)};
}

std::span<const double> sums_of(const MeshEmission& emission, int triangle) {
  if (!emission.map) return {};
  const std::size_t first = emission.first_sum[std::size_t(triangle)];
  return {emission.row_sums.data() + first, emission.first_sum[std::size_t(triangle) + 1] - first};
}

}  // namespace

Rgb covered_emission_at(const Scene& scene, int mesh, int triangle, const V2f& barycentric) {
  const Rgb emission = emission_at(scene, mesh, triangle, barycentric);
  if (material_of(scene, mesh).alpha_mode == AlphaMode::opaque) return emission;
  return emission * coverage_at(scene, mesh, triangle, barycentric);
}

std::vector<std::unique_ptr<const MeshEmission>> make_mesh_emissions(const Scene& scene) {
  std::vector<std::unique_ptr<const MeshEmission>> emissions(scene.meshes.size());
  std::vector<int> meshes;
  std::vector<bool> placed(scene.meshes.size(), false);
  for (const Instance& instance : scene.instances) {
    if (placed[std::size_t(instance.mesh)] || is_black(material_of(scene, instance.mesh).emission)) continue;
    placed[std::size_t(instance.mesh)] = true;
    meshes.push_back(instance.mesh);
  }
  // Material by material, so that no two have their sums of radiance at a time.
  std::ranges::stable_sort(meshes, {}, [&](int m) { return scene.meshes[std::size_t(m)].material; });

  std::map<int, std::shared_ptr<EmissionMap>> maps;  // of one material, by cells joined
  double bytes = 0;
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const int index = meshes[k];
    const Mesh& mesh = scene.meshes[std::size_t(index)];
    const Material& material = material_of(scene, index);
    auto emission = std::make_unique<MeshEmission>();
    emission->mesh = index;
    bytes += double(mesh.triangles.size()) * (sizeof(Rgb) + sizeof(std::uint32_t));
    check_memory(scene.name, bytes, "use fewer emissive triangles");
    emission->mean_radiance.assign(mesh.triangles.size(), Rgb(0, 0, 0));
    std::optional<EmissionMap> axes = make_emission_axes(scene, mesh.material);
    // Alpha above 1 covers what the texture alone leaves out.
    if (axes && material.alpha_mode == AlphaMode::mask &&
        std::ranges::any_of(mesh.colors, [](const V4f& color) { return color.w > 1; }))
      axes.reset();
    if (axes) {
      const int join = cells_to_join(scene, index, *axes);
      std::shared_ptr<EmissionMap>& map = maps[join];
      if (!map) {
        const double cells = double(axes->x.count) * axes->y.count / join / join;
        const bool stored = join > 1 || material.alpha_mode != AlphaMode::opaque;
        check_memory(scene.name, bytes + cells * (stored ? 18 : 6), "use smaller emissive textures or fewer of them");
        bytes += cells * 4.5;
        map = std::make_shared<EmissionMap>(*make_emission_map(scene, mesh.material, join));
      }
      emission->map = map;
      integrate(scene, *emission);
      bytes += double(emission->row_sums.size()) * sizeof(double);
    } else {
      const int steps = steps_for(mesh);
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        emission->mean_radiance[t] = sampled_mean(scene, index, int(t), steps);
    }
    emissions[std::size_t(index)] = std::move(emission);
    if (k + 1 == meshes.size() || scene.meshes[std::size_t(meshes[k + 1])].material != mesh.material) {
      for (auto& [join, map] : maps) forget_radiance(*map);
      maps.clear();
    }
  }
  return emissions;
}

EmissionPoint sample_point(const Scene& scene, const MeshEmission& emission, int triangle, RandomStream& random) {
  const std::span<const double> sums = sums_of(emission, triangle);
  if (sums.empty() || !(sums.back() > 0)) return {sample_triangle(random.next2()), 1};
  const EmissionMap& map = *emission.map;
  const Mesh& mesh = scene.meshes[std::size_t(emission.mesh)];
  const TexelPolygon polygon = polygon_of(map, mesh, triangle);
  const double whole_cell = cell_area(polygon);
  double target = double(random.next_u32()) * 0x1p-32 * sums.back();
  const std::uint32_t u_cell = random.next_u32();
  const float u_part = random.next();
  const V2f u = random.next2();

  const auto group = std::size_t(std::upper_bound(sums.begin(), sums.end() - 1, target) - sums.begin());
  const auto [first, last] = cells_of(polygon, map.y, &TexelCorner::y);
  int row = first + int(group) * emission.rows_a_sum;
  const int end_row = std::min(last + 1, row + emission.rows_a_sum);
  target -= group > 0 ? sums[group - 1] : 0;

  // The row of the group, then the cell of the row: the last that has weight, should rounding leave a rest.
  const auto row_weight = [&](int j) {
    double weight = 0;
    visit_row(
        polygon, map.x, map.y, j, [&](int begin, int end) { weight += run_weight(map, begin, end, j) * whole_cell; },
        [&](int i, const TexelPolygon& part) { weight += cell_weight(map, i, j) * area_of(part); });
    return weight;
  };
  double in_row = emission.rows_a_sum == 1 ? sums[group] - (group > 0 ? sums[group - 1] : 0) : row_weight(row);
  int next_row = row;
  for (double weight = in_row; target >= weight && next_row + 1 < end_row;) {
    target -= weight;
    weight = row_weight(++next_row);
    if (!(weight > 0)) continue;
    row = next_row;
    in_row = weight;
  }
  target = double(u_cell) * 0x1p-32 * in_row;
  int cell = 0;
  bool found = false;
  visit_row(
      polygon, map.x, map.y, row,
      [&](int begin, int end) {
        const double run = run_weight(map, begin, end, row) * whole_cell;
        if (!(run > 0) || (found && target < 0)) return;
        cell = find_in_run(map, begin, end, row, std::min(target, run * (1 - 1e-12)) / whole_cell);
        found = true;
        target -= run;
      },
      [&](int i, const TexelPolygon& part) {
        const double here = cell_weight(map, i, row) * area_of(part);
        if (!(here > 0) || (found && target < 0)) return;
        cell = i;
        found = true;
        target -= here;
      });
  const TexelPolygon part =
      clipped_to_cell(clipped_to_cell(polygon, map.y, &TexelCorner::y, row), map.x, &TexelCorner::x, cell);
  if (!found || part.empty()) return {V2f(0, 0), 0};
  const V2f b = point_in(part, u_part, u);
  // Asked again for the point as rounded: at a texel's edge it may belong to the neighbour, and evaluation and density
  // must then agree about that.
  return {b, point_density(scene, emission, triangle, b)};
}

float point_density(const Scene& scene, const MeshEmission& emission, int triangle, const V2f& barycentric) {
  const std::span<const double> sums = sums_of(emission, triangle);
  if (sums.empty() || !(sums.back() > 0)) return 1;
  const Imath::V2i cell = cell_at(*emission.map, scene.meshes[std::size_t(emission.mesh)], triangle, barycentric);
  constexpr double area = 0.5;  // of barycentric coordinates
  return float(cell_weight(*emission.map, cell.x, cell.y) * area / sums.back());
}

}  // namespace ivory
