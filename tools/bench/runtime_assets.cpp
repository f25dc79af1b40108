#include "tools/bench/runtime_assets.h"

#include <cmath>

#include "grid/env/environment_image.h"
#include "grid/env/irradiance.h"
#include "grid/env/latlong_map.h"
#include "grid/field/resolve.h"
#include "tracer/bake/cubemap/capture.h"
#include "tracer/bake/field/baker.h"
#include "tracer/bake/fiv/baker.h"
#include "tracer/bake/spheres/fit.h"

namespace ivory {

Mesh make_floor(float half_side_m) {
  const float s = half_side_m;
  Mesh mesh;
  mesh.positions = {{-s, 0, -s}, {-s, 0, s}, {s, 0, s}, {s, 0, -s}};
  mesh.normals.assign(4, V3f(0, 1, 0));
  mesh.triangles.emplace_back(0, 1, 2);
  mesh.triangles.emplace_back(0, 2, 3);
  return mesh;
}

RuntimeBenchAssets make_runtime_bench_assets(const Scene& object, const EnvironmentMap& environment, int grid_side) {
  RuntimeBenchAssets out;
  out.occluder = make_fiv_occluder(object);
  out.triangles = triangle_count(object);
  out.environment = cube_from_environment(environment, 32);
  out.sh9 = sh9_from_moments(cube_moments(out.environment, 0, out.environment.size));
  const EnvironmentImage image{EnvironmentLayout::latlong, environment};
  out.difmap.e = bake_irradiance(make_irradiance_tree(image), 64).e;

  FivParams fiv;
  fiv.samples = {64, 33, 30};
  fiv.hemispheres = 6;
  out.table = bake_fiv(out.occluder, out.environment, fiv);

  Scene stage = object;
  Material white;
  white.metallic = 0;
  white.specular = 0;
  white.base_color = Rgb(0.7F, 0.7F, 0.7F);
  stage.materials.push_back(white);
  Mesh floor = make_floor(4);
  floor.material = int(stage.materials.size()) - 1;
  stage.meshes.push_back(std::move(floor));
  Instance instance;
  instance.mesh = int(stage.meshes.size()) - 1;
  stage.instances.push_back(instance);
  stage.environment = environment;
  const LitScene lit = make_lit_scene(std::move(stage));
  GridBakeParams grid;
  grid.resolution = V3i(grid_side, grid_side, grid_side);
  grid.photons = 1'000'000;
  out.grid = resolve(bake_grid_sums(lit, grid));
  grid.levels = 3;
  out.levels = resolve(bake_grid_sums(lit, grid));

  CaptureParams capture;
  capture.size = 64;
  capture.samples = 1;
  const Box3f box = bounds(object);
  const V3f above(box.center().x, box.max.y + 1, box.center().z);
  out.cube = localize(capture_cube(lit, above, capture).cube, 4);
  out.lobes = make_lobe_table();
  out.spheres = fit_spheres(object, SphereFitParams{}).set;
  return out;
}

FivTable resampled(const FivTable& table, const V3i& size) {
  FivTable out = table;
  out.size = size;
  out.radii.clear();
  out.values.clear();
  const float first = table.radii.front();
  const float range = table.radii.back() / first;
  for (int k = 0; k < size.z; ++k) out.radii.push_back(first * std::pow(range, float(k) / float(size.z - 1)));
  const auto numbers = std::ptrdiff_t(3 * fiv_function_count(table.hemispheres));
  for (const float r : out.radii) {
    for (int p = 0; p < size.y; ++p) {
      for (int a = 0; a < size.x; ++a) {
        const FivMoments m = lookup(table, V3f(fiv_sample_direction(size, a, p)) * r);
        out.values.insert(out.values.end(), m.begin(), m.begin() + numbers);
      }
    }
  }
  return out;
}

Scene subdivided(Scene scene, int times) {
  for (Mesh& mesh : scene.meshes) {
    mesh.normals.clear();
    mesh.tangents.clear();
    mesh.uvs.clear();
    mesh.colors.clear();
    for (int i = 0; i < times; ++i) {
      std::vector<Imath::Vec3<std::uint32_t>> triangles;
      for (const auto& t : mesh.triangles) {
        const auto first = std::uint32_t(mesh.positions.size());
        for (unsigned k = 0; k < 3; ++k)
          mesh.positions.push_back((mesh.positions[t[k]] + mesh.positions[t[(k + 1) % 3]]) * 0.5F);
        triangles.emplace_back(t.x, first, first + 2);
        triangles.emplace_back(first, t.y, first + 1);
        triangles.emplace_back(first + 2, first + 1, t.z);
        triangles.emplace_back(first, first + 1, first + 2);
      }
      mesh.triangles = std::move(triangles);
    }
  }
  return scene;
}

std::size_t triangle_count(const Scene& scene) {
  std::size_t count = 0;
  for (const Instance& instance : scene.instances) count += scene.meshes[std::size_t(instance.mesh)].triangles.size();
  return count;
}

std::vector<V3f> strewn_on_floor(int count, float half_side_m) {
  std::vector<V3f> out;
  for (int i = 1; i <= count; ++i) {
    // Roberts's sequence of dimension 2: even whatever the count.
    const auto part = [i](double step) { return float(std::fmod(0.5 + step * i, 1.0)); };
    out.emplace_back(half_side_m * (2 * part(0.7548776662) - 1), 0, half_side_m * (2 * part(0.5698402910) - 1));
  }
  return out;
}

}  // namespace ivory
