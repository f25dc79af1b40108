// Rows that trace rays: photons, look-ups, paths, cube maps.
#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "grid/field/resolve.h"
#include "tools/bench/measure_lookup.h"
#include "tools/bench/measure_row.h"
#include "tools/bench/measure_tracer.h"
#include "tracer/bake/cubemap/capture.h"
#include "tracer/bake/field/baker.h"
#include "tracer/core/sampling.h"
#include "tracer/core/surface.h"
#include "tracer/render/guard_rays.h"
#include "tracer/render/path_tracer.h"

namespace ivory {
namespace {

std::size_t scaled(double count, const BenchAllParams& params) {
  return std::max<std::size_t>(1, std::size_t(count * params.scale));
}

// A room with two blocks in it and a lamp.
Scene make_box() {
  Scene scene;
  scene.name = "box";
  Material material;
  material.base_color = Rgb(0.7F, 0.6F, 0.5F);
  material.metallic = 0;
  material.specular = 0;
  material.double_sided = true;
  scene.materials.push_back(material);
  Mesh mesh;
  mesh.material = 0;
  const auto add = [&](const V3f& low, const V3f& high) {
    const auto first = std::uint32_t(mesh.positions.size());
    for (int corner = 0; corner < 8; ++corner)
      mesh.positions.emplace_back((corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                                  (corner & 4) != 0 ? high.z : low.z);
    constexpr std::array<std::array<std::uint32_t, 4>, 6> faces{
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    for (const auto& f : faces) {
      mesh.triangles.emplace_back(first + f[0], first + f[1], first + f[2]);
      mesh.triangles.emplace_back(first + f[0], first + f[2], first + f[3]);
    }
  };
  add({0, 0, 0}, {4, 2.5F, 4});
  add({0.6F, 0, 0.7F}, {1.4F, 1.6F, 1.5F});
  add({2.2F, 0, 1.9F}, {3.2F, 0.8F, 3});
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({0, M44f()});
  scene.lights.emplace_back(PointLight{V3f(2.1F, 2.2F, 1.7F), Rgb(100, 100, 100)});
  return scene;
}

BenchRow photon_row(Scene scene, const BenchAllParams& params) {
  const LitScene lit = make_lit_scene(std::move(scene));
  TracerBenchParams tracer;
  tracer.photons = scaled(100'000, params);
  tracer.threads = params.threads;
  PhotonBench bench(lit, tracer);
  return measure_seconds(
      params, {"", "segments", "Embree's closest hits of the same rays"}, double(bench.rays()),
      [&] { return bench.deposit_s(); }, [&] { return bench.replay_s(); });
}

// Light of the box seen from its middle: one ray to a surface and one to the lamp, a sample.
struct Eyes {
  std::vector<Ray> rays;
  std::vector<Ray> shadow_rays;
};
Eyes make_eyes(const LitScene& lit, std::size_t count) {
  Eyes eyes;
  RandomStream random(1, StreamPurpose::test, 0);
  const V3f lamp = std::get<PointLight>(lit.scene->lights.front()).position;
  for (std::size_t i = 0; i < count; ++i) {
    const Ray ray{.origin = lit.intersector.center(), .direction = sample_sphere(random.next2())};
    eyes.rays.push_back(ray);
    const auto hit = lit.intersector.closest(ray);
    if (!hit) continue;
    const Surface surface = make_surface(*lit.scene, ray, *hit);
    const V3f to = lamp - surface.p;
    if (to.dot(surface.ng) <= 0) continue;
    Ray shadow = spawn_ray(surface, to.normalized());
    shadow.t_max = to.length();
    eyes.shadow_rays.push_back(shadow);
  }
  return eyes;
}

template <typename Work>
void for_each(std::size_t count, const Work& work) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) work(i);
  });
}

void trace_bare(const Intersector& intersector, const Eyes& eyes) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, eyes.rays.size(), 1024), [&](const auto& range) {
    intersector.count_hits(std::span<const Ray>(eyes.rays).subspan(range.begin(), range.size()));
  });
  std::vector<float> kept(eyes.shadow_rays.size());
  for_each(kept.size(), [&](std::size_t i) { kept[i] = intersector.transmittance(eyes.shadow_rays[i]); });
}

IrradianceGrid bake_box(const LitScene& lit, const BenchAllParams& params) {
  GridBakeParams bake;
  bake.resolution = V3i(32, 32, 32);
  bake.photons = scaled(200'000, params);
  bake.threads = params.threads;
  return resolve(bake_grid_sums(lit, bake));
}

// Bound of looking up: the numbers of the eight vertices around a point, added up.
BenchRow lookup_row(Guard guard, const BenchAllParams& params) {
  const LitScene lit = make_lit_scene(make_box());
  const IrradianceGrid grid = bake_box(lit, params);
  const SurfacePoints points = surface_points(grid.frame, lit.intersector, int(scaled(50'000, params)));
  std::vector<Rgb> results(points.p.size());  // kept, so that the compiler keeps the work
  LookupParams lookup;
  lookup.guard = guard;
  const auto look_up = [&] {
    for_each(points.p.size(), [&](std::size_t i) {
      results[i] = lookup_irradiance(grid, &lit.intersector, points.p[i], points.n[i], points.n[i], lookup);
    });
  };
  const std::size_t stride = grid.moments.size() / grid.frame.vertex_count();
  const auto read = [&] {
    for_each(points.p.size(), [&](std::size_t i) {
      const V3f at = grid.frame.to_index(points.p[i]);
      V3i low;
      for (int axis = 0; axis < 3; ++axis) low[axis] = std::clamp(int(at[axis]), 0, grid.frame.size[axis] - 2);
      float sum = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const float* moments =
            grid.moments.data() +
            stride * grid.frame.vertex_index(low.x + (corner & 1), low.y + (corner >> 1 & 1), low.z + (corner >> 2));
        for (std::size_t k = 0; k < stride; ++k) sum += moments[k];
      }
      results[i].x = sum;
    });
  };
  return measure_row(params, {"", "look-ups", "the eight vertices' numbers added up"}, double(points.p.size()), look_up,
                     read);
}

BenchRow path_row(const BenchAllParams& params) {
  const LitScene lit = make_lit_scene(make_box());
  const Eyes eyes = make_eyes(lit, scaled(100'000, params));
  std::vector<Rgb> results(eyes.rays.size());
  PathParams path;
  path.max_bounces = 1;
  return measure_row(
      params, {"", "rays", "Embree's closest hits and shadow rays alone"},
      double(eyes.rays.size() + eyes.shadow_rays.size()),
      [&] {
        for_each(eyes.rays.size(), [&](std::size_t i) {
          RandomStream random(1, StreamPurpose::test, i);
          results[i] = trace_path(lit, eyes.rays[i], path, random);
        });
      },
      [&] { trace_bare(lit.intersector, eyes); });
}

BenchRow cubemap_row(const BenchAllParams& params) {
  const LitScene lit = make_lit_scene(make_box());
  const IrradianceGrid grid = bake_box(lit, params);
  GridLight light;
  light.grid = &grid;
  CaptureParams capture;
  capture.size = 64;
  capture.samples = int(scaled(4, params));
  capture.threads = params.threads;
  capture.grid = &light;
  const Eyes eyes = make_eyes(lit, std::size_t(6) * 64 * 64 * std::size_t(capture.samples));
  return measure_row(
      params, {"", "rays", "Embree's closest hits and shadow rays alone"},
      double(eyes.rays.size() + eyes.shadow_rays.size()), [&] { capture_cube(lit, lit.intersector.center(), capture); },
      [&] { trace_bare(lit.intersector, eyes); });
}

}  // namespace

std::vector<RowMaker> scene_rows() {
  using Params = BenchAllParams;
  return {{"photon segments, box", [](const Params& params) { return photon_row(make_box(), params); }},
          {"photon segments, 250 k triangles",
           [](const Params& params) { return photon_row(make_bench_scene(250'000), params); }},
          {"photon segments, 1 M triangles",
           [](const Params& params) { return photon_row(make_bench_scene(1'000'000), params); }},
          {"look-ups, guarded by rays", [](const Params& params) { return lookup_row(Guard::rays, params); }},
          {"look-ups, guarded by planes", [](const Params& params) { return lookup_row(Guard::planes, params); }},
          {"look-ups, unguarded", [](const Params& params) { return lookup_row(Guard::off, params); }},
          {"path tracer", path_row},
          {"cube map bake", cubemap_row}};
}

}  // namespace ivory
