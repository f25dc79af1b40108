// Rendering from stored indirect light: read at the visible surface, or gathered one bounce away from it.
// Camera, direct light and film are the path tracer's.
#pragma once

#include <functional>

#include "grid/field/irradiance_grid.h"
#include "tracer/render/direct_light.h"
#include "tracer/render/lookup_tally.h"
#include "tracer/render/render.h"

namespace ivory {

// A grid and how it is read. It must hold indirect light only.
struct GridLight {
  const IrradianceGrid* grid = nullptr;
  LookupParams lookup{.guard = Guard::rays};
  LookupTally* tally = nullptr;  // counts the look-ups, where given
};

// E in lux of indirect light at a surface, from whatever stores it. Called from any thread.
using IndirectLight = std::function<Rgb(const Surface&)>;
// That of the grid; `lit` and `grid` must outlive it.
IndirectLight indirect_light(const LitScene& lit, const GridLight& grid);

struct GatherParams {
  // Rays a sample that gather light at the first surface seen; 0 reads the stored light there.
  int gather_rays = 0;
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

// The picture of trace_gather(); threads, seed and samples as in render_film(). Throws as that does.
Film render_gather(const LitScene& lit, const IndirectLight& indirect, const View& view, const RenderParams& render,
                   const GatherParams& params);

}  // namespace ivory
