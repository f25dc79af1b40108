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

// A sign of a few bright texels, a lamp far away: emitters so small that the rays through the texels miss them, and
// that light samples find. What covers fewer than four texels, by the density of a light sample there, is counted by
// light samples and left out by rays; what covers more is seen by rays alone, without the noise of choosing.
class SmallEmitters {
 public:
  SmallEmitters(const LitScene& lit, const V3f& origin, const CaptureParams& params)
      : lit_(lit), origin_(origin), params_(params), count_(1024.0 * params.samples), any_(lit.lights.has_extended()) {}

  // Is what a ray from the origin meets counted by light samples?
  bool counted_for(const Ray& ray) const {
    if (!any_) return false;
    const std::optional<Hit> hit = lit_.intersector.closest(ray);
    return hit && by_light(ray.direction, lit_.lights.pdf_solid_angle(origin_, *hit));
  }

  void add_to(CubeMap& map) const {
    if (!any_) return;
    for (int k = 0; k < int(count_); ++k) {
      RandomStream random(params_.seed, StreamPurpose::capture, map.texels.size() + std::size_t(k));
      const std::optional<LightSample> s = lit_.lights.sample(origin_, random);
      if (!s || s->delta || !std::isfinite(s->distance_m) || !by_light(s->w, s->pdf_solid_angle)) continue;
      const V3f to_end = offset_origin(s->point, s->ng, -s->w, s->reach_m) - origin_;
      const float distance = to_end.length();
      Ray shadow{.origin = origin_, .direction = to_end / distance, .t_max = distance};
      const std::size_t texel = cube_texel(map.size, s->w);
      const int in_face = int(texel % (std::size_t(map.size) * std::size_t(map.size)));
      const double solid_angle = cube_texel_solid_angle(map.size, in_face / map.size, in_face % map.size);
      const Rgb radiance =
          s->irradiance_weight * (lit_.intersector.transmittance(shadow) / float(count_ * solid_angle));
      for (int c = 0; c < 3; ++c)
        map.texels[texel][c] = std::min(map.texels[texel][c] + radiance[c], greatest_radiance_nits);
    }
  }

 private:
  // Rays are even over a texel of a face of side 2 at distance 1: dw = dA m^3 with m the largest component of w.
  bool by_light(const V3f& w, float pdf_light) const {
    const double m = double(std::max({std::abs(w.x), std::abs(w.y), std::abs(w.z)}));
    return 4 * double(pdf_light) > 0.25 * params_.size * params_.size / (m * m * m);
  }

  const LitScene& lit_;
  V3f origin_;
  const CaptureParams& params_;
  double count_;
  bool any_;
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

  const SmallEmitters small(lit, origin, params);
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
      const bool emits = !small.counted_for(ray);
      const PathParams path{.count_first_emission = emits};
      const GatherParams gather{.count_first_emission = emits};
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
  small.add_to(cube.radiance);
  for (const RowShares& row : shares) {
    capture.sky_share += row.sky / (4 * double(pi));
    capture.back_share += row.back / (4 * double(pi));
  }
  return capture;
}

}  // namespace ivory
