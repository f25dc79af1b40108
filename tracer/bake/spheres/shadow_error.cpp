#include "tracer/bake/spheres/shadow_error.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "grid/base/counted_random.h"
#include "tracer/bake/fiv/occluder.h"
#include "tracer/core/intersector.h"
#include "tracer/core/low_discrepancy.h"
#include "tracer/core/sampling.h"

// Mesh and set are asked along the same rays, so that only those count that one hides and the other does not. With d
// and d' the mean differences over two independent halves of the rays, the mean of d d' is that of the squared
// difference of the hidden shares, without the rays' noise.

namespace ivory {

namespace {

// Ray `k` of a receiver, uniform over the lamp; the first half of the rays is one scrambled sequence, the second
// another.
V3f ray_direction(const ShadowTruth& truth, std::size_t receiver, int k) {
  const auto half = std::uint32_t(k / truth.rays);
  const std::uint32_t key =
      low_discrepancy::hash(std::uint32_t(truth.seed) * 0x9e3779b9U + std::uint32_t(receiver)) ^ (half * 0x68bc21ebU);
  const auto u = sobol_point(std::uint32_t(k % truth.rays), key);
  const double z = 1 - double(u[0]) * 0x1p-32 * (1 - std::cos(shadow_lamp_half_angle_rad));
  const double s = std::sqrt(std::max(0.0, 1 - z * z));
  const double phi = 2 * double(pi) * double(u[1]) * 0x1p-32;
  const ShadingFrame frame = make_shading_frame(truth.receivers[receiver].axis);
  return frame.to_world(V3f(float(s * std::cos(phi)), float(s * std::sin(phi)), float(z))).normalized();
}

}  // namespace

ShadowTruth trace_shadow_truth(const Scene& scene, const ShadowTruthParams& params) {
  const FivOccluder occluder = make_fiv_occluder(scene);
  const Intersector object(occluder.scene);
  ShadowTruth truth;
  truth.rays = params.rays;
  truth.seed = params.seed;
  truth.center_m = occluder.center_m;
  truth.radius_m = occluder.radius_m;
  truth.receivers.resize(std::size_t(params.receivers));
  const double span = std::log(farthest_shadow_receiver / nearest_shadow_receiver);
  tbb::parallel_for(std::size_t(0), truth.receivers.size(), [&](std::size_t i) {
    ShadowTruth::Receiver& receiver = truth.receivers[i];
    const auto uniform = [&](std::size_t k) { return counted_uniform(params.seed, 6 * i + k); };
    const V3d p = sphere_direction(uniform(0), uniform(1)) * (nearest_shadow_receiver * std::exp(span * uniform(2)));
    const V3d before = sphere_direction(uniform(3), uniform(4)) * std::cbrt(uniform(5));
    receiver.p = V3f(p);
    receiver.axis = V3f((before - p).normalized());
    for (int k = 0; k < 2 * params.rays; ++k) {
      Ray ray;
      ray.origin = receiver.p;
      ray.direction = ray_direction(truth, i, k);
      ray.blocking_coverage = half_coverage;
      receiver.hidden.push_back(object.closest(ray).has_value());
    }
  });
  return truth;
}

MeasuredError shadow_error(const SphereSet& set, const ShadowTruth& truth) {
  std::vector<Sphere> unit;
  for (const Sphere& sphere : set.spheres)
    unit.push_back({(sphere.center - truth.center_m) / truth.radius_m, sphere.radius_m / truth.radius_m});
  const SphereGroups groups = make_sphere_groups(std::move(unit));
  std::vector<PointError> points(truth.receivers.size());
  tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
    const ShadowTruth::Receiver& receiver = truth.receivers[i];
    std::vector<Sphere> near;
    // A little wider than the lamp, as rounding may turn rays out of it.
    const double half_angle = 1.001 * shadow_lamp_half_angle_rad;
    find_hiding(groups, {receiver.p, receiver.axis, float(std::cos(half_angle)), float(std::sin(half_angle))}, near);
    double difference[2] = {0, 0};
    for (int k = 0; k < 2 * truth.rays; ++k) {
      const V3f w = ray_direction(truth, i, k);
      const bool hidden =
          std::any_of(near.begin(), near.end(), [&](const Sphere& sphere) { return meets(sphere, receiver.p, w); });
      difference[k / truth.rays] += (double(hidden) - double(bool(receiver.hidden[std::size_t(k)]))) / truth.rays;
    }
    points[i] = {difference[0] * difference[1], 1};
  });
  return root_mean_square(points);
}

}  // namespace ivory
