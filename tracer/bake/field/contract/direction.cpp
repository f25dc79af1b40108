#include "tracer/bake/field/contract/direction.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>

#include "tracer/core/sampler.h"
#include "tracer/core/sampling.h"
#include "tracer/core/surface.h"
#include "tracer/render/path_tracer.h"

namespace ivory {
namespace {

constexpr std::array<Basis, 3> bases{Basis::vectors, Basis::vectors9, Basis::sh9};
constexpr std::size_t most_points = 128;
constexpr int directions = 512;  // in each of two halves

// What arrives from there after at least one bounce: the light that a grid stores.
Rgb indirect_radiance(const LitScene& lit, const V3f& p, const V3f& w, const TruthParams& params,
                      RandomStream& random) {
  Ray ray;
  ray.origin = p;
  ray.direction = w;
  ray.coverage_seed = random.next_u32();
  const auto hit = lit.intersector.closest(ray);
  if (!hit) return {0, 0, 0};
  PathParams path;
  path.max_bounces = params.max_bounces;
  return trace_scattered(lit, make_surface(*lit.scene, ray, *hit), -w, path, random);
}

using Offsets = std::array<V3d, bases.size()>;  // reconstructed E less E, lux

Offsets half(const LitScene& lit, const V3f& p, const V3f& n, const GridFrame& frame, const TruthParams& params,
             RandomStream& random) {
  std::array<std::array<double, 3 * max_functions>, bases.size()> sums{};
  V3d e(0, 0, 0);
  const std::uint32_t key = random.next_u32();
  constexpr std::uint32_t even_calls = 8;
  for (int i = 0; i < directions; ++i) {
    random.begin_sample(std::uint32_t(i), key, even_calls);
    const V3f w = sample_sphere(random.next2());
    const V3d l(indirect_radiance(lit, p, w, params, random));
    if (l == V3d(0, 0, 0)) continue;
    e += l * double(std::max(0.0F, n.dot(w)));
    for (std::size_t b = 0; b < bases.size(); ++b) {
      const auto f = eval(bases[b], frame.direction_to_local(w));
      for (std::size_t k = 0; k < std::size_t(function_count(bases[b])); ++k) {
        for (unsigned c = 0; c < 3; ++c) sums[b][3 * k + c] += l[c] * double(f[k]);
      }
    }
  }
  random.begin_sample(0, 0, 0);
  constexpr double solid_angle = 4.0 * double(pi) / directions;
  Offsets out;
  for (std::size_t b = 0; b < bases.size(); ++b) {
    std::array<float, 3 * max_functions> moments;
    std::transform(sums[b].begin(), sums[b].end(), moments.begin(), [](double s) { return float(s * solid_angle); });
    out[b] = V3d(irradiance(bases[b], Reconstruction::optimal, moments.data(), frame.direction_to_local(n))) -
             e * solid_angle;
  }
  return out;
}

}  // namespace

DirectionErrors direction_errors(const LitScene& lit, const std::vector<MeasuredPoint>& points, const GridFrame& frame,
                                 double mean_e_lux, const TruthParams& params) {
  const std::size_t stride = std::max<std::size_t>(1, (points.size() + most_points - 1) / most_points);
  const std::size_t count = (points.size() + stride - 1) / stride;
  std::vector<std::array<double, bases.size()>> squares(count);
  const V3f& h = frame.spacing_m;
  const float off_m = LookupParams{}.nudge_voxels * std::min({h.x, h.y, h.z});
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
    const TruePoint& point = points[i * stride].point;
    RandomStream random(params.seed, StreamPurpose::domain, (std::uint64_t(1) << 62U) + point.index);
    V3f p = offset_origin(point.at.p, point.at.n, point.at.n);
    const auto ahead = lit.intersector.closest(
        {.origin = p, .direction = point.at.n, .t_max = 2 * off_m, .blocking_coverage = half_coverage});
    p += point.at.n * (ahead ? std::min(off_m, ahead->t / 2) : off_m);
    const Offsets a = half(lit, p, point.at.n, frame, params, random);
    const Offsets b = half(lit, p, point.at.n, frame, params, random);
    // Halves are independent: the product's expectation has no noise in it.
    for (std::size_t k = 0; k < bases.size(); ++k) squares[i][k] = point.at.weight * a[k].dot(b[k]) / 3;
  });
  double weights = 0;
  std::array<double, bases.size()> sums{};
  for (std::size_t i = 0; i < count; ++i) {
    weights += points[i * stride].point.at.weight;
    for (std::size_t k = 0; k < bases.size(); ++k) sums[k] += squares[i][k];
  }
  const auto share = [&](double sum) { return std::sqrt(std::max(0.0, sum / weights)) / mean_e_lux; };
  return {share(sums[0]), share(sums[1]), share(sums[2])};
}

}  // namespace ivory
