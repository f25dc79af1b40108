#include "tracer/bake/cubemap/capture.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "grid/base/memory.h"
#include "tracer/core/surface.h"
#include "tracer/render/path_tracer.h"

namespace ivory {

namespace {

// As for pixels (render.cpp): position, coverage, the light and the BSDF sample of the first surface.
constexpr std::uint32_t even_calls = 7;

// Of one row of texels, summed over in a fixed order afterwards.
struct RowShares {
  double sky = 0;
  double back = 0;
};

}  // namespace

Capture capture_cube(const LitScene& lit, const V3f& origin, const CaptureParams& params) {
  const int size = params.size;
  const std::size_t texels = std::size_t(cube_faces) * std::size_t(size) * std::size_t(size);
  check_memory("a capture of 6x" + std::to_string(size) + "x" + std::to_string(size) + " texels", double(texels) * 16,
               "choose a smaller one");
  Capture capture;
  CapturedCube& cube = capture.cube;
  cube.origin_m = origin;
  cube.anchor_m = lit.scene->anchor_m;
  cube.radiance.size = size;
  cube.radiance.texels.resize(texels);
  cube.inverse_distance.resize(texels);

  const PathParams path;
  const GatherParams gather;
  const auto ray_through = [&](int face, double row, double column, RandomStream& random) {
    Ray ray;
    ray.origin = origin;
    ray.direction = V3f(cube_point(face, 2 * column / size - 1, 2 * row / size - 1).normalized());
    ray.coverage_seed = random.next_u32();
    return ray;
  };
  const auto capture_texel = [&](int face, int row, int column, RowShares& shares) {
    const std::size_t i = cube_index(size, face, row, column);
    RandomStream random(params.seed, StreamPurpose::capture, i);
    const std::uint32_t key = random.next_u32();
    double sum[3] = {0, 0, 0};
    for (int k = 0; k < params.samples; ++k) {
      random.begin_sample(std::uint32_t(k), key, even_calls);
      const V2f u = random.next2();
      const Ray ray = ray_through(face, double(row) + double(u.y), double(column) + double(u.x), random);
      const Rgb radiance = params.grid != nullptr ? trace_gather(lit, *params.grid, ray, gather, random)
                                                  : trace_path(lit, ray, path, random);
      for (int c = 0; c < 3; ++c) sum[c] += double(radiance[c]);
    }
    for (int c = 0; c < 3; ++c)
      cube.radiance.texels[i][c] = float(std::min(sum[c] / params.samples, double(greatest_radiance_nits)));

    const Ray ray = ray_through(face, row + 0.5, column + 0.5, random);
    const std::optional<Hit> hit = lit.intersector.closest(ray);
    cube.inverse_distance[i] = hit ? 1 / std::max(hit->t, least_depth_m) : 0.0F;
    const double solid_angle = cube_texel_solid_angle(size, row, column);
    if (!hit) {
      shares.sky += solid_angle;
      return;
    }
    const Scene& scene = *lit.scene;
    const Mesh& mesh = scene.meshes[std::size_t(scene.instances[std::size_t(hit->instance)].mesh)];
    const bool single_sided = !scene.materials[std::size_t(mesh.material)].double_sided;
    if (single_sided && ray.direction.dot(hit->ng) > 0) shares.back += solid_angle;
  };

  const std::size_t rows = std::size_t(cube_faces) * std::size_t(size);
  std::vector<RowShares> shares(rows);
  std::atomic<std::size_t> done{0};
  tbb::task_arena arena(params.threads > 0 ? params.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(std::size_t(0), rows, [&](std::size_t r) {
      const int face = int(r / std::size_t(size));
      const int row = int(r % std::size_t(size));
      for (int column = 0; column < size; ++column) capture_texel(face, row, column, shares[r]);
      const std::size_t finished = ++done;
      if (params.progress) params.progress(double(finished) / double(rows));
    });
  });
  for (const RowShares& row : shares) {
    capture.sky_share += row.sky / (4 * double(pi));
    capture.back_share += row.back / (4 * double(pi));
  }
  return capture;
}

}  // namespace ivory
