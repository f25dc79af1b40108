#include "tracer/lights/emission/mesh.h"

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
#include "tracer/lights/emission/integral.h"

namespace ivory {

namespace {

// Rows and columns of cells that the triangles of a mesh may span in all: a second of one thread, and half a dozen
// microseconds a triangle.
constexpr double most_work = 0x1p21;
constexpr double most_work_a_triangle = 24;
// Lit cells under coverage that is not a function of the cell, each integrated by itself.
constexpr double most_cells = 0x1p22;
constexpr std::size_t most_sums = std::size_t(1) << 20U;

const Material& material_of(const Scene& scene, int mesh) {
  return scene.materials[std::size_t(scene.meshes[std::size_t(mesh)].material)];
}

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
  const EmissionIntegrator integrator(scene, emission.mesh, map);
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
        const EmissionIntegrator::Row row = integrator.row(polygon, whole_cell, int(t), j);
        weight += row.weight;
        light += row.light;
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
  const double u_row = double(random.next_u32()) * 0x1p-32;
  const double u_cell = double(random.next_u32()) * 0x1p-32;
  return sample_point(scene, emission, triangle, {u_row, u_cell}, random);
}

EmissionPoint sample_point(const Scene& scene, const MeshEmission& emission, int triangle, const Imath::V2d& u_point,
                           RandomStream& random) {
  const std::span<const double> sums = sums_of(emission, triangle);
  if (sums.empty() || !(sums.back() > 0)) return {sample_triangle(V2f(u_point)), 1};
  const EmissionMap& map = *emission.map;
  const Mesh& mesh = scene.meshes[std::size_t(emission.mesh)];
  const TexelPolygon polygon = polygon_of(map, mesh, triangle);
  const double whole_cell = cell_area(polygon);
  double target = u_point.x * sums.back();
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
  target = u_point.y * in_row;
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
