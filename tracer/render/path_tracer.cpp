#include "tracer/render/path_tracer.h"

#include <algorithm>

// A path x_1 x_2 ... leaves the eye and scatters at each x_k. With throughput
// T_k = product of f cos / p over its first k scatterings (and over the survival probabilities of
// Russian roulette), the light that reaches the eye is
//
//   L = L_e(x_1) + sum_k [ T_{k-1} direct light sampled at x_k + T_k w_b L_e(x_{k+1}) ],
//
// w_b the weight of emission_weight(): emission that the path runs into and light that it samples
// are two estimators of the same integral.

namespace ivory {

namespace {

// Bounces before Russian roulette may end a path: most of an image's light has bounced less.
constexpr int roulette_after = 3;
// Paths between perfectly white walls would never end. With s the most survival and albedo rho > s, a path of k
// bounces weighs (rho / s)^k and happens s^k of the time: its square's mean (rho^2 / s)^k must not grow with k, so s
// has to lie above the square of the whitest closed room's albedo, here 0.9995.
constexpr float most_survival = 0.999F;

}  // namespace

Rgb trace_scattered(const LitScene& lit, const Surface& first, const V3f& first_wo, const PathParams& params,
                    RandomStream& random) {
  Rgb radiance(0, 0, 0);
  Rgb throughput(1, 1, 1);
  Surface surface = first;
  V3f wo = first_wo;
  for (int bounce = 1; bounce <= params.max_bounces; ++bounce) {
    const Bsdf bsdf = make_bsdf(surface);
    const bool counts = bounce > 1 || !params.indirect_only;
    if (counts) radiance += throughput * sample_direct(lit, surface, bsdf, wo, params.strategy, random);
    // The last ray of a path only looks for light, of which there may be none to run into.
    if (bounce == params.max_bounces && !(counts && lit.lights.has_extended())) break;

    const float u_lobe = random.next();
    const std::optional<BsdfSample> s = sample(bsdf, wo, u_lobe, random.next2());
    if (!s) break;
    throughput *= s->throughput;
    if (bounce >= roulette_after) {
      const float survival = std::min(most_survival, max_component(throughput));
      if (!(random.next() < survival)) break;
      throughput /= survival;
    } else if (is_black(throughput)) {
      break;
    }

    const Ray ray = spawn_ray(surface, s->wi, random.next_u32());
    const std::optional<Hit> hit = lit.intersector.closest(ray);
    if (!hit) {
      if (counts) {
        radiance += throughput * lit.lights.environment_radiance(s->wi) *
                    environment_weight(lit.lights, s->wi, s->pdf_solid_angle, params.strategy);
      }
      break;
    }
    const V3f p = surface.p;
    surface = make_surface(*lit.scene, ray, *hit);
    wo = -s->wi;
    if (counts && !is_black(surface.emission)) {
      radiance +=
          throughput * surface.emission * emission_weight(lit.lights, p, *hit, s->pdf_solid_angle, params.strategy);
    }
  }
  return radiance;
}

Rgb trace_path(const LitScene& lit, const Ray& ray, const PathParams& params, RandomStream& random) {
  const std::optional<Hit> hit = lit.intersector.closest(ray);
  if (!hit) return params.indirect_only ? Rgb(0, 0, 0) : lit.lights.environment_radiance(ray.direction);
  const Surface surface = make_surface(*lit.scene, ray, *hit);
  const bool emits = params.count_first_emission && !params.indirect_only;
  const Rgb emission = emits ? surface.emission : Rgb(0, 0, 0);
  return emission + trace_scattered(lit, surface, -ray.direction, params, random);
}

Film render_path(const LitScene& lit, const View& view, const RenderParams& render, const PathParams& params) {
  return render_film(view, render,
                     [&](const Ray& ray, RandomStream& random) { return trace_path(lit, ray, params, random); });
}

}  // namespace ivory
