// Rendering from stored indirect light: read at the visible surface, or gathered one bounce away from it.
// Camera, direct light and film are the path tracer's.
#pragma once

#include <concepts>
#include <functional>
#include <utility>

#include "grid/field/irradiance_grid.h"
#include "tracer/render/direct_light.h"
#include "tracer/render/gather/cache.h"
#include "tracer/render/lookup_tally.h"
#include "tracer/render/render.h"

namespace ivory {

// A grid and how it is read. It must hold indirect light only.
struct GridLight {
  const IrradianceGrid* grid = nullptr;
  LookupParams lookup{.guard = Guard::rays};
  LookupTally* tally = nullptr;  // counts the look-ups, where given
  bool rays_in_doubt = false;    // whatever lookup.guard: by planes and, where they leave a doubt, rays (guard_rays.h)
};

// Indirect light from whatever stores it. Called from any thread.
struct IndirectLight {
  std::function<Rgb(const Surface&)> irradiance;  // E in lux at a surface
  // How far apart what is stored around a place stands, in metres: light that changes faster is not in it. Where
  // given, what lies nearer than that is not read behind gather rays (GatherParams::near_bounces).
  std::function<float(const V3f&)> spacing_m;

  template <std::invocable<const Surface&> E>
  IndirectLight(E e, std::function<float(const V3f&)> spacing = {})  // NOLINT(google-explicit-constructor)
      : irradiance(std::move(e)), spacing_m(std::move(spacing)) {}
  Rgb operator()(const Surface& surface) const { return irradiance(surface); }
};
// That of the grid; `lit` and `grid` must outlive it.
IndirectLight indirect_light(const LitScene& lit, const GridLight& grid);

struct GatherParams {
  // Rays a sample that gather light at the first surface seen; 0 reads the stored light there.
  int gather_rays = 0;
  // Surfaces in a row, each nearer to the one before than what is stored is spaced, from which a gather ray goes on
  // instead of reading: a contact is darker than the store tells.
  int near_bounces = 2;
  // E at the first surface seen, where it knows of it; gather rays are for other places. Null: for all.
  const IrradianceCache* cache = nullptr;
  // Surfaces in a row whose microfacet reflections are followed; light that they reflect is shaded with
  // direct and stored light.
  int max_specular_bounces = 16;
  // Only light with at least one more surface between its source and the first surface seen.
  bool indirect_only = false;
  bool count_first_emission = true;  // what the first surface seen shines with
  DirectStrategy strategy = DirectStrategy::mis;
};

// One estimate of the radiance in nits along an eye ray.
Rgb trace_gather(const LitScene& lit, const IndirectLight& indirect, const Ray& ray, const GatherParams& params,
                 RandomStream& random);
Rgb trace_gather(const LitScene& lit, const GridLight& grid, const Ray& ray, const GatherParams& params,
                 RandomStream& random);

// One estimate of E in lux at a white Lambertian surface (white_receiver() of probe.h), at its shading normal: pi times
// what it reflects.
Rgb gather_irradiance(const LitScene& lit, const IndirectLight& indirect, const Surface& white,
                      const GatherParams& params, RandomStream& random);

// What a ray brings that left a surface: what its hit reflects, not what that emits, which is direct light to where the
// ray left. params.gather_rays and the cache are not used.
GatheredLight gather_light(const LitScene& lit, const IndirectLight& indirect, const Ray& ray,
                           const GatherParams& params, RandomStream& random);

// The picture of trace_gather(); threads, seed and samples as in render_film(). Throws as that does.
Film render_gather(const LitScene& lit, const IndirectLight& indirect, const View& view, const RenderParams& render,
                   const GatherParams& params);

}  // namespace ivory
