#include "tracer/render/direct_light.h"

#include <algorithm>
#include <cmath>

// With p_l(w) the density of light sampling and p_b(w) that of the BSDF, the two estimators
//
//   f cos L / p_l  weighted by p_l^2 / (p_l^2 + (q p_b)^2)       (a light sample)
//   f cos L / p_b  weighted by (q p_b)^2 / (p_l^2 + (q p_b)^2)   (the ray that the path sends on anyway)
//
// add up to the integral of f cos L because their weights add up to 1 in every direction. The path that goes on from
// one of several surfaces at random has a ray from each with a probability q, and so q rays in the mean: Veach's
// heuristic counts them as it would more samples. Where several lights are sampled, p_l is the sum of their densities,
// which in any one direction is that of one: a light is sampled by one of the samples alone.

namespace ivory {

namespace {

// As a ratio: densities of small lights overflow when squared.
float power_heuristic(float pdf, float other) {
  const float ratio = other / pdf;
  return 1.0F / (1.0F + ratio * ratio);
}

float weight(float pdf_bsdf, float pdf_light, const DirectSampling& sampling) {
  // What sampling lights can never find counts in full.
  if (pdf_light == 0 || sampling.strategy == DirectStrategy::bsdf) return 1;
  if (sampling.strategy == DirectStrategy::light) return 0;
  return power_heuristic(sampling.bsdf_share * pdf_bsdf, pdf_light);
}

// Eight units in the last place of the largest coordinate of either end.
float point_clearance_m(const V3f& a, const V3f& b) {
  return 0x1p-20F *
         std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z), std::abs(b.x), std::abs(b.y), std::abs(b.z)});
}

Rgb from_light(const LitScene& lit, const Surface& surface, const Bsdf& bsdf, const V3f& wo,
               const DirectSampling& sampling, const LightSample& light) {
  const BsdfValue f = eval_with_pdf(bsdf, wo, light.w);
  Rgb radiance = f.value * light.irradiance_weight;
  if (is_black(radiance)) return radiance;
  if (!light.delta && sampling.strategy != DirectStrategy::light) {
    if (sampling.strategy == DirectStrategy::bsdf) return {0, 0, 0};
    radiance *= power_heuristic(light.pdf_solid_angle, sampling.bsdf_share * f.pdf_solid_angle);
  }

  Ray shadow = spawn_ray(surface, light.w);
  if (std::isfinite(light.distance_m)) {
    // Both ends stay clear of their own surfaces by the rounding error of the coordinates, whatever the distance
    // between them: an emitter's end along its normal, as a ray leaving it would start. A lamp without a surface
    // may hang in the plane of one (a ceiling), where hit or miss would be up to rounding: a few units in the
    // last place short of it.
    const bool has_surface = light.ng != V3f(0, 0, 0);
    const V3f end = has_surface ? offset_origin(light.point, light.ng, -light.w, light.reach_m) : light.point;
    const V3f to_end = end - shadow.origin;
    // The two clearances overlap: there is no room left in which anything could be told apart.
    if (!(to_end.dot(light.w) > 0)) return radiance;
    const float distance = to_end.length();
    shadow.direction = to_end / distance;
    shadow.t_max = has_surface ? distance : distance - point_clearance_m(surface.p, end);
  }
  return radiance * lit.intersector.transmittance(shadow);
}

}  // namespace

Rgb sample_direct(const LitScene& lit, const Surface& surface, const Bsdf& bsdf, const V3f& wo,
                  const DirectSampling& sampling, RandomStream& random) {
  Rgb radiance(0, 0, 0);
  const Receiver receiver = receiver_at(surface);
  const int samples = lit.lights.samples(sampling.pick);
  for (int i = 0; i < samples; ++i) {
    if (const std::optional<LightSample> light = lit.lights.sample(receiver, sampling.pick, i, random))
      radiance += from_light(lit, surface, bsdf, wo, sampling, *light);
  }
  return radiance;
}

float emission_weight(const Lights& lights, const Receiver& from, const Hit& hit, float pdf_bsdf,
                      const DirectSampling& sampling) {
  return weight(pdf_bsdf, lights.pdf_solid_angle(from, hit, sampling.pick), sampling);
}

float environment_weight(const Lights& lights, const Receiver& from, const V3f& w, float pdf_bsdf,
                         const DirectSampling& sampling) {
  return weight(pdf_bsdf, lights.environment_pdf_solid_angle(from, w, sampling.pick), sampling);
}

}  // namespace ivory
