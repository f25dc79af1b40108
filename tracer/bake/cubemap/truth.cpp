#include "tracer/bake/cubemap/truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <tbb/parallel_for.h>

#include "grid/base/counted_random.h"
#include "grid/cubemap/reader.h"
#include "tracer/core/sampling.h"
#include "tracer/core/surface.h"
#include "tracer/render/path_tracer.h"

// E(p, n) = integral of L(w) max(n.w, 0) dw, L all that arrives but for delta lights, which a cube map does not hold.
// Light that shines by itself is estimated twice, by a ray of density cos/pi that may run into it and by a sampled
// light, each weighted by the power heuristic (Veach 1997, section 9.2) as in tracer/render/direct_light.h; what the
// ray meets scatters the rest, as path tracing finds it.

namespace ivory {

namespace {

constexpr double of_the_way = 0.98;
constexpr double reach_means = 3;
constexpr int probe_directions = 1024;

// Distance to the first surface, infinite where there is none.
double free_distance(const Intersector& intersector, const V3f& origin, const V3f& w) {
  Ray ray;
  ray.origin = origin;
  ray.direction = w;
  ray.blocking_coverage = half_coverage;
  const std::optional<Hit> hit = intersector.closest(ray);
  return hit ? double(hit->t) : std::numeric_limits<double>::infinity();
}

double reach_around(const Intersector& intersector, const V3f& origin) {
  double inverse = 0;
  for (int i = 0; i < probe_directions; ++i) {
    // Fibonacci's lattice.
    const double turn = 0.6180339887498949 * i;
    const V3f w(sphere_direction((i + 0.5) / probe_directions, turn - std::floor(turn)));
    inverse += 1 / free_distance(intersector, origin, w) / probe_directions;
  }
  return inverse > 0 ? reach_means / inverse : 1;
}

V3d estimate(const LitScene& lit, const V3f& p, const V3f& n, int paths, std::uint64_t seed, std::uint64_t index) {
  constexpr std::uint32_t calls = 6;  // direction and coverage of the ray, light and place on it
  RandomStream random(seed, StreamPurpose::probe, index);
  const std::uint32_t key = random.next_u32();
  const ShadingFrame frame = make_shading_frame(n);
  const Receiver receiver{p, n};
  V3d sum(0, 0, 0);
  for (int k = 0; k < paths; ++k) {
    random.begin_sample(std::uint32_t(k), key, calls);
    const V2f u = random.next2();
    const float s = std::sqrt(u.x);
    const float phi = 2 * pi * u.y;
    const float cosine = std::sqrt(std::max(0.0F, 1 - u.x));
    Ray ray;
    ray.origin = p;
    ray.direction = frame.to_world(V3f(s * std::cos(phi), s * std::sin(phi), cosine)).normalized();
    ray.coverage_seed = random.next_u32();
    if (const std::optional<LightSample> light = lit.lights.sample(receiver, LightPick::one, 0, random);
        light && !light->delta) {
      const float facing = n.dot(light->w);
      if (facing > 0) {
        Ray shadow{.origin = p, .direction = light->w};
        if (std::isfinite(light->distance_m)) {
          const V3f to_end = offset_origin(light->point, light->ng, -light->w, light->reach_m) - p;
          shadow.t_max = to_end.length();
          shadow.direction = to_end / shadow.t_max;
        }
        const double by_light = double(light->pdf_solid_angle);
        const double by_ray = double(facing / pi);
        const double weight = by_light * by_light / (by_light * by_light + by_ray * by_ray);
        sum += V3d(light->irradiance_weight) * (weight * double(facing * lit.intersector.transmittance(shadow)));
      }
    }
    if (!(cosine > 0)) continue;
    const float pdf = cosine / pi;
    const std::optional<Hit> hit = lit.intersector.closest(ray);
    Rgb radiance(0, 0, 0);
    if (hit) {
      const Surface surface = make_surface(*lit.scene, ray, *hit);
      if (!is_black(surface.emission))
        radiance += surface.emission * emission_weight(lit.lights, receiver, *hit, pdf, DirectStrategy::mis);
      radiance += trace_scattered(lit, surface, -ray.direction, {}, random);
    } else {
      radiance = lit.lights.environment_radiance(ray.direction) *
                 environment_weight(lit.lights, receiver, ray.direction, pdf, DirectStrategy::mis);
    }
    sum += V3d(radiance) * double(pi);
  }
  return sum / double(paths);
}

double mean_of(const CubeReceiver& receiver) {
  const V3d sum = receiver.e[0] + receiver.e[1];
  return (sum.x + sum.y + sum.z) / 6;
}

}  // namespace

CubeTruth trace_cube_truth(const LitScene& lit, const V3f& origin, const CubeTruthParams& params) {
  CubeTruth truth;
  truth.reach_m = reach_around(lit.intersector, origin);
  truth.receivers.resize(std::size_t(params.receivers));
  tbb::parallel_for(std::size_t(0), truth.receivers.size(), [&](std::size_t i) {
    CubeReceiver& receiver = truth.receivers[i];
    const auto uniform = [&](std::size_t k) { return counted_uniform(params.seed, 5 * i + k); };
    const V3f w(sphere_direction(uniform(0), uniform(1)));
    const double way = of_the_way * std::min(truth.reach_m, free_distance(lit.intersector, origin, w));
    receiver.p = origin + w * float(way * std::cbrt(uniform(2)));
    receiver.n = V3f(sphere_direction(uniform(3), uniform(4))).normalized();
    for (std::size_t k = 0; k < 2; ++k)
      receiver.e[k] = estimate(lit, receiver.p, receiver.n, params.paths, params.seed, 2 * i + k);
  });
  const auto all = double(truth.receivers.size());
  double mean = 0;
  for (const CubeReceiver& receiver : truth.receivers) mean += mean_of(receiver) / all;
  std::erase_if(truth.receivers, [&](const CubeReceiver& receiver) { return mean_of(receiver) > most_of_mean * mean; });
  truth.dazzled = params.receivers - int(truth.receivers.size());
  return truth;
}

MeasuredError cube_error(const LocalizedCube& cube, const CubeTruth& truth) {
  const CubeReader reader = make_cube_reader(cube, CubeMethod::polygon);
  std::vector<PointError> points(truth.receivers.size());
  tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
    const CubeReceiver& receiver = truth.receivers[i];
    const V3d e(irradiance(reader, receiver.p, receiver.n));
    for (int c = 0; c < 3; ++c) {
      points[i].squared += (e[c] - receiver.e[0][c]) * (e[c] - receiver.e[1][c]) / 3;
    }
    points[i].truth = mean_of(receiver);
  });
  return root_mean_square(points);
}

}  // namespace ivory
