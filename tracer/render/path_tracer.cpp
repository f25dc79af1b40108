#include "tracer/render/path_tracer.h"

#include <algorithm>
#include <cmath>

#include "tracer/render/crossings.h"

// A path leaves the eye. Each of its rays crosses surfaces x_i of part coverage and ends at a whole one: together they
// are seen with weights w_i (crossings.h). It scatters at one of them, c, chosen with probability q_c. With throughput
// T_k = product of (w_c / q_c) f cos / p over its first k scatterings (and over the survival probabilities of Russian
// roulette), the light that reaches the eye is
//
//   L = sum_i w_i L_e(x_i) + sum_k T_{k-1} sum_i w_i direct light sampled at x_i + sum_k T_k sum_j w_j w_b L_e(x_j),
//
// x_i the surfaces on the k-th ray, x_j those on the next, w_b the weight of emission_weight(): emission that the path
// runs into and light that it samples are two estimators of the same integral.

namespace ivory {

namespace {

// Bounces before Russian roulette may end a path: most of an image's light has bounced less.
constexpr int roulette_after = 3;
// Paths between perfectly white walls would never end. With s the most survival and albedo rho > s, a path of k
// bounces weighs (rho / s)^k and happens s^k of the time: its square's mean (rho^2 / s)^k must not grow with k, so s
// has to lie above the square of the whitest closed room's albedo, here 0.9995.
constexpr float most_survival = 0.999F;

// Scatterings whose random numbers are spread evenly over a pixel's samples; those further on depend on too many for
// the samples to cover.
constexpr int even_scatterings = 2;
constexpr std::uint32_t most_even_calls = 8;

// The random numbers of one scattering: the lights of each surface, which surface the path goes on from, and how. Each
// has sequences of its own, so that crossed surfaces do not mix up those of the others.
enum Part : std::uint32_t { light_of_first = 0, choice = Passage::most + 1, way_on, count };

void begin_part(RandomStream& random, int bounce, std::uint32_t part) {
  random.begin_part(std::uint32_t(bounce) * Part::count + part, bounce <= even_scatterings ? most_even_calls : 0);
}

// What the surfaces seen along wo send against it, but for their own emission.
Rgb scattered(const LitScene& lit, SeenSurfaces& seen, const V3f& first_wo, const PathParams& params,
              RandomStream& random) {
  Rgb radiance(0, 0, 0);
  Rgb throughput(1, 1, 1);
  V3f wo = first_wo;
  for (int bounce = 1; bounce <= params.max_bounces; ++bounce) {
    const auto shares = going_on(seen);
    std::size_t chosen = 0;
    if (seen.count > 1) {
      begin_part(random, bounce, Part::choice);
      chosen = choose(std::span(shares).first(seen.count), random.next());
    }
    if (!(shares[chosen] > 0)) break;
    const Surface surface = seen.surfaces[chosen];
    const Bsdf bsdf = make_bsdf(surface);
    const Rgb before = throughput;
    throughput *= seen.weights[chosen] / shares[chosen];

    // Of the surfaces that the eye sees all are lit, further on only the one that the path goes on from. Most noise is
    // that of the first two: they are lit by each light, others by one.
    const bool eye = bounce == 1;
    DirectSampling sampling(params.strategy, bounce <= even_scatterings ? LightPick::each : LightPick::one);
    const bool counts = !eye || !params.indirect_only;
    // The last ray of a path only looks for light, of which there may be none to run into.
    const bool goes_on = bounce < params.max_bounces || (counts && lit.lights.has_extended());
    for (std::size_t i = 0; counts && eye && i < seen.count; ++i) {
      if (i == chosen || !(shares[i] > 0)) continue;
      begin_part(random, bounce, Part::light_of_first + std::uint32_t(i));
      sampling.bsdf_share = goes_on ? shares[i] : 0;
      radiance += before * seen.weights[i] *
                  sample_direct(lit, seen.surfaces[i], make_bsdf(seen.surfaces[i]), wo, sampling, random);
    }
    sampling.bsdf_share = !goes_on ? 0.0F : eye ? shares[chosen] : 1.0F;
    if (counts) {
      begin_part(random, bounce, Part::light_of_first + std::uint32_t(chosen));
      radiance +=
          (eye ? before * seen.weights[chosen] : throughput) * sample_direct(lit, surface, bsdf, wo, sampling, random);
    }
    if (!goes_on) break;

    begin_part(random, bounce, Part::way_on);
    const float u_lobe = random.next();
    const std::optional<BsdfSample> s = sample(bsdf, wo, u_lobe, random.next2());
    if (!s) break;
    throughput *= s->throughput;
    if (bounce >= roulette_after) {
      // Of weight T, sqrt(T) go on at sqrt(T): to let T go on at 1 saves little time for much noise.
      const float survival = std::min(most_survival, std::sqrt(max_component(throughput)));
      if (!(random.next() < survival)) break;
      throughput /= survival;
    } else if (is_black(throughput)) {
      break;
    }

    const Ray ray = spawn_ray(surface, s->wi, random.next_u32());
    const Crossings crossings = cross_surfaces(lit, ray);
    const Receiver from = receiver_at(surface);
    if (counts && crossings.beyond > 0) {
      radiance += throughput * lit.lights.environment_radiance(s->wi) * crossings.beyond *
                  environment_weight(lit.lights, from, s->wi, s->pdf_solid_angle, sampling);
    }
    wo = -s->wi;
    seen.count = 0;
    for (std::size_t i = 0; i < crossings.count; ++i) {
      const auto& [hit, weight] = crossings.seen[i];
      const Surface next = make_surface(*lit.scene, ray, hit);
      if (counts && !is_black(next.emission)) {
        radiance +=
            throughput * next.emission * weight * emission_weight(lit.lights, from, hit, s->pdf_solid_angle, sampling);
      }
      seen.add(next, weight);
    }
    if (seen.count == 0) break;
  }
  return radiance;
}

}  // namespace

Rgb trace_scattered(const LitScene& lit, const Surface& surface, const V3f& wo, const PathParams& params,
                    RandomStream& random) {
  SeenSurfaces seen;
  seen.add(surface, 1);
  return scattered(lit, seen, wo, params, random);
}

Rgb trace_path(const LitScene& lit, const Ray& ray, const PathParams& params, RandomStream& random) {
  const Crossings crossings = cross_surfaces(lit, ray);
  Rgb radiance(0, 0, 0);
  if (crossings.beyond > 0 && !params.indirect_only)
    radiance = lit.lights.environment_radiance(ray.direction) * crossings.beyond;
  const bool emits = params.count_first_emission && !params.indirect_only;
  SeenSurfaces seen;
  for (std::size_t i = 0; i < crossings.count; ++i) {
    const Surface surface = make_surface(*lit.scene, ray, crossings.seen[i].hit);
    if (emits) radiance += surface.emission * crossings.seen[i].weight;
    seen.add(surface, crossings.seen[i].weight);
  }
  if (seen.count == 0) return radiance;
  return radiance + scattered(lit, seen, -ray.direction, params, random);
}

Film render_path(const LitScene& lit, const View& view, const RenderParams& render, const PathParams& params) {
  return render_film(view, render,
                     [&](const Ray& ray, RandomStream& random) { return trace_path(lit, ray, params, random); });
}

}  // namespace ivory
