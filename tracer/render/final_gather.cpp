#include "tracer/render/final_gather.h"

#include <algorithm>
#include <cmath>

#include "tracer/render/crossings.h"
#include "tracer/render/guard_rays.h"

// At a surface x seen from wo, reflected light splits by lobe and by how far its light has come:
//
//   L = direct light, both lobes                                   sample_direct() and one BSDF ray (MIS)
//     + indirect light, diffuse lobe     R_d(wo)/pi E(x)           read from what is stored, or
//                                        1/N sum f_d cos/p L_r(y)  gathered at the hits y of N rays
//     + indirect light, specular lobe    f_s cos/p L_r(y)          the BSDF ray again, shaded at its hit y
//
// Of the surfaces of part coverage that the eye's ray crosses each is seen so, with its weight (crossings.h).
// L_r(y) is what y reflects, by the same sum with stored light at its diffuse lobe. What y emits is left out:
// to x that is direct light.

namespace ivory {

namespace {

// Random numbers of a gather ray that are spread evenly over all gather rays of a pixel: its direction,
// coverage, and the light (which, where on it) at its hit.
constexpr std::uint32_t even_calls = 5;
// And of each surface that the eye sees: of its direct light, of each light, and of the ray that it sends on.
enum Part : std::uint32_t { lights, way_on, is_seen, count };
constexpr std::uint32_t most_even_calls = 8;

// Surfaces of less weight than this are looked at now and then, for more.
constexpr float least_share = 1.0F / 32;

void begin_part(RandomStream& random, int place, std::uint32_t part) {
  random.begin_part(std::uint32_t(place) * Part::count + part, most_even_calls);
}

struct Gatherer {
  const LitScene& lit;
  const IndirectLight& indirect;
  const GatherParams& params;

  Rgb from_store(const Surface& surface, const Bsdf& bsdf, const V3f& wo) const {
    const Rgb reflectance = diffuse_reflectance(bsdf, wo);
    return is_black(reflectance) ? reflectance : reflectance / pi * indirect(surface);
  }

  Rgb gathered(const Surface& surface, const Bsdf& bsdf, const V3f& wo, RandomStream& random) const {
    Rgb sum(0, 0, 0);
    if (is_black(bsdf.diffuse_albedo)) return sum;
    for (int i = 0; i < params.gather_rays; ++i) {
      random.begin_branch(std::uint32_t(i), std::uint32_t(params.gather_rays), even_calls);
      const std::optional<BsdfSample> s = sample(bsdf, wo, 1, random.next2(), Lobes::diffuse);
      if (!s) continue;
      const Ray ray = spawn_ray(surface, s->wi, random.next_u32());
      sum += s->throughput * light_along(ray, params.near_bounces, random).radiance;
    }
    random.end_branches();
    return sum / float(params.gather_rays);
  }

  // What the ray's hit reflects. Nearer to its origin than what is stored is spaced, stored light is not read there
  // but gathered, by one ray: `near_bounces` hits in a row at most.
  GatheredLight light_along(const Ray& ray, int near_bounces, RandomStream& random) const {
    const std::optional<Hit> hit = lit.intersector.closest(ray);
    if (!hit) return {};
    const Surface y = make_surface(*lit.scene, ray, *hit);
    const bool near = near_bounces > 0 && indirect.spacing_m && hit->t < indirect.spacing_m(y.p);
    return {reflected(y, -ray.direction, behind_the_eye, random, near ? near_bounces : 0),
            1 / std::max(hit->t, 1e-20F)};
  }

  // Indirect light that the diffuse lobe reflects, by one ray.
  Rgb gone_on(const Surface& surface, const Bsdf& bsdf, const V3f& wo, int near_bounces, RandomStream& random) const {
    const Rgb black(0, 0, 0);
    if (is_black(bsdf.diffuse_albedo)) return black;
    const std::optional<BsdfSample> s = sample(bsdf, wo, 1, random.next2(), Lobes::diffuse);
    if (!s) return black;
    const Ray ray = spawn_ray(surface, s->wi, random.next_u32());
    return s->throughput * light_along(ray, near_bounces - 1, random).radiance;
  }

  // Indirect light that the diffuse lobe reflects at the first surface seen.
  Rgb gathered_or_cached(const Surface& surface, const Bsdf& bsdf, const V3f& wo, RandomStream& random) const {
    if (params.cache != nullptr) {
      if (const std::optional<Rgb> e = params.cache->irradiance(surface))
        return diffuse_reflectance(bsdf, wo) / pi * *e;
    }
    return gathered(surface, bsdf, wo, random);
  }

  // Radiance that the surface reflects towards wo. `place` is its place among those that the eye's ray crosses, or
  // behind_the_eye for others. With near_bounces above 0 it lies too near to something for stored light.
  static constexpr int behind_the_eye = -1;
  Rgb reflected(const Surface& first_surface, const V3f& first_wo, int place, RandomStream& random,
                int near_bounces = 0) const {
    Rgb radiance(0, 0, 0);
    Rgb throughput(1, 1, 1);
    Surface surface = first_surface;
    V3f wo = first_wo;
    for (int bounce = 0; bounce < params.max_specular_bounces; ++bounce) {
      const Bsdf bsdf = make_bsdf(surface);
      const bool seen_first = place != behind_the_eye && bounce == 0;
      const bool counts_direct = !(seen_first && params.indirect_only);
      // Most noise is that of the surfaces seen: they are lit by each light, others by one.
      const DirectSampling sampling(params.strategy, seen_first ? LightPick::each : LightPick::one);
      if (seen_first) begin_part(random, place, Part::lights);
      if (counts_direct) radiance += throughput * sample_direct(lit, surface, bsdf, wo, sampling, random);
      if (seen_first && params.gather_rays > 0) {
        radiance += throughput * gathered_or_cached(surface, bsdf, wo, random);
      } else if (bounce == 0 && near_bounces > 0) {
        radiance += throughput * gone_on(surface, bsdf, wo, near_bounces, random);
      } else {
        radiance += throughput * from_store(surface, bsdf, wo);
      }

      const bool looks_for_light = counts_direct && lit.lights.has_extended();
      const bool reflects = !is_lambertian(bsdf);
      if (!looks_for_light && !reflects) break;
      if (seen_first) begin_part(random, place, Part::way_on);
      const float u_lobe = random.next();
      const std::optional<BsdfSample> s =
          sample(bsdf, wo, u_lobe, random.next2(), looks_for_light ? Lobes::all : Lobes::specular);
      if (!s) break;

      // The specular lobe's share of this ray goes on, if Russian roulette lets it: weak reflections
      // cost as much to shade as strong ones, which a survival of the root of their weight balances.
      Rgb specular(0, 0, 0);
      if (reflects) {
        specular = throughput * eval(bsdf, wo, s->wi, Lobes::specular) / s->pdf_solid_angle;
        const float survival = std::min(1.0F, std::sqrt(max_component(specular)));
        specular = survival > 0 && random.next() < survival ? specular / survival : Rgb(0, 0, 0);
      }
      if (is_black(specular) && !looks_for_light) break;

      const Ray ray = spawn_ray(surface, s->wi, random.next_u32());
      const std::optional<Hit> hit = lit.intersector.closest(ray);
      if (!hit) {
        if (looks_for_light) {
          radiance += throughput * s->throughput * lit.lights.environment_radiance(s->wi) *
                      environment_weight(lit.lights, receiver_at(surface), s->wi, s->pdf_solid_angle, sampling);
        }
        break;
      }
      const Receiver from = receiver_at(surface);
      surface = make_surface(*lit.scene, ray, *hit);
      wo = -s->wi;
      if (looks_for_light && !is_black(surface.emission)) {
        radiance += throughput * s->throughput * surface.emission *
                    emission_weight(lit.lights, from, *hit, s->pdf_solid_angle, sampling);
      }
      if (is_black(specular)) break;
      throughput = specular;
    }
    return radiance;
  }
};

}  // namespace

IndirectLight indirect_light(const LitScene& lit, const GridLight& grid) {
  const auto read = [&lit, &grid](const Surface& surface) {
    const Footprint footprint =
        grid.rays_in_doubt
            ? lookup_footprint_in_doubt_by_rays(*grid.grid, lit.intersector, surface.p, surface.ng, grid.lookup)
            : lookup_footprint(*grid.grid, &lit.intersector, surface.p, surface.ng, grid.lookup);
    if (grid.tally != nullptr) grid.tally->add(footprint.count > 0, grid.grid->frame.covers(surface.p));
    return irradiance(*grid.grid, footprint, surface.ns, grid.lookup.reconstruction);
  };
  const auto spacing_m = [&grid](const V3f& p) {
    const V3f& h = grid.grid->frame_of(level_shares(*grid.grid, {.p = p}).level[0]).spacing_m;
    return std::min({h.x, h.y, h.z});
  };
  return {read, spacing_m};
}

Rgb trace_gather(const LitScene& lit, const IndirectLight& indirect, const Ray& ray, const GatherParams& params,
                 RandomStream& random) {
  const Crossings crossings = cross_surfaces(lit, ray);
  Rgb radiance(0, 0, 0);
  if (crossings.beyond > 0 && !params.indirect_only)
    radiance = lit.lights.environment_radiance(ray.direction) * crossings.beyond;
  const bool emits = params.count_first_emission && !params.indirect_only;
  const Gatherer gatherer{lit, indirect, params};
  for (std::size_t i = 0; i < crossings.count; ++i) {
    const Surface surface = make_surface(*lit.scene, ray, crossings.seen[i].hit);
    float weight = crossings.seen[i].weight;
    if (emits) radiance += surface.emission * weight;
    if (weight < least_share) {
      begin_part(random, int(i), Part::is_seen);
      if (!(random.next() * least_share < weight)) continue;
      weight = least_share;
    }
    radiance += gatherer.reflected(surface, -ray.direction, int(i), random) * weight;
  }
  return radiance;
}

Rgb trace_gather(const LitScene& lit, const GridLight& grid, const Ray& ray, const GatherParams& params,
                 RandomStream& random) {
  return trace_gather(lit, indirect_light(lit, grid), ray, params, random);
}

Rgb gather_irradiance(const LitScene& lit, const IndirectLight& indirect, const Surface& white,
                      const GatherParams& params, RandomStream& random) {
  const Gatherer gatherer{lit, indirect, params};
  return gatherer.reflected(white, white.ns, /*place=*/0, random) * pi;
}

GatheredLight gather_light(const LitScene& lit, const IndirectLight& indirect, const Ray& ray,
                           const GatherParams& params, RandomStream& random) {
  return Gatherer{lit, indirect, params}.light_along(ray, params.near_bounces, random);
}

Film render_gather(const LitScene& lit, const IndirectLight& indirect, const View& view, const RenderParams& render,
                   const GatherParams& params) {
  return render_film(view, render, [&](const Ray& ray, RandomStream& random) {
    return trace_gather(lit, indirect, ray, params, random);
  });
}

}  // namespace ivory
