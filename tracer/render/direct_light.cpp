#include "tracer/render/direct_light.h"

#include <algorithm>
#include <cmath>

// With p_l(w) the density of light sampling and p_b(w) that of the BSDF, the two estimators
//
//   f cos L / p_l  weighted by p_l^2 / (p_l^2 + p_b^2)     (one light sample)
//   f cos L / p_b  weighted by p_b^2 / (p_l^2 + p_b^2)     (the ray that the path sends on anyway)
//
// add up to the integral of f cos L because their weights add up to 1 in every direction.

namespace ivory {

namespace {

// As a ratio: densities of small lights overflow when squared.
float power_heuristic(float pdf, float other) {
  const float ratio = other / pdf;
  return 1.0F / (1.0F + ratio * ratio);
}

float weight(float pdf_bsdf, float pdf_light, DirectStrategy strategy) {
  // What sampling lights can never find counts in full.
  if (pdf_light == 0 || strategy == DirectStrategy::bsdf) return 1;
  return strategy == DirectStrategy::light ? 0.0F : power_heuristic(pdf_bsdf, pdf_light);
}

// Eight units in the last place of the largest coordinate of either end.
float point_clearance_m(const V3f& a, const V3f& b) {
  return 0x1p-20F *
         std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z), std::abs(b.x), std::abs(b.y), std::abs(b.z)});
}

}  // namespace

Rgb sample_direct(const LitScene& lit, const Surface& surface, const Bsdf& bsdf, const V3f& wo, DirectStrategy strategy,
                  RandomStream& random) {
  const Rgb black(0, 0, 0);
  const std::optional<LightSample> light = lit.lights.sample(surface.p, random);
  if (!light) return black;
  const BsdfValue f = eval_with_pdf(bsdf, wo, light->w);
  Rgb radiance = f.value * light->irradiance_weight;
  if (is_black(radiance)) return black;
  if (!light->delta && strategy != DirectStrategy::light) {
    if (strategy == DirectStrategy::bsdf) return black;
    radiance *= power_heuristic(light->pdf_solid_angle, f.pdf_solid_angle);
  }

  Ray shadow = spawn_ray(surface, light->w);
  if (std::isfinite(light->distance_m)) {
    // Both ends stay clear of their own surfaces by the rounding error of the coordinates, whatever the distance
    // between them: an emitter's end along its normal, as a ray leaving it would start. A lamp without a surface
    // may hang in the plane of one (a ceiling), where hit or miss would be up to rounding: a few units in the
    // last place short of it.
    const bool has_surface = light->ng != V3f(0, 0, 0);
    const V3f end = has_surface ? offset_origin(light->point, light->ng, -light->w, light->reach_m) : light->point;
    const V3f to_end = end - shadow.origin;
    // The two clearances overlap: there is no room left in which anything could be told apart.
    if (!(to_end.dot(light->w) > 0)) return radiance;
    const float distance = to_end.length();
    shadow.direction = to_end / distance;
    shadow.t_max = has_surface ? distance : distance - point_clearance_m(surface.p, end);
  }
  return radiance * lit.intersector.transmittance(shadow);
}

float emission_weight(const Lights& lights, const V3f& p, const Hit& hit, float pdf_bsdf, DirectStrategy strategy) {
  return weight(pdf_bsdf, lights.pdf_solid_angle(p, hit), strategy);
}

float environment_weight(const Lights& lights, const V3f& w, float pdf_bsdf, DirectStrategy strategy) {
  return weight(pdf_bsdf, lights.environment_pdf_solid_angle(w), strategy);
}

}  // namespace ivory
