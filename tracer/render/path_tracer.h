// The reference: path tracing with next-event estimation, multiple importance sampling and Russian
// roulette. Unbiased but for max_bounces.
#pragma once

#include "tracer/render/direct_light.h"
#include "tracer/render/render.h"

namespace ivory {

struct PathParams {
  // Surfaces that light may scatter at between its source and the eye; 1 is direct light, 0 only
  // what shines by itself. Russian roulette ends paths long before the default.
  int max_bounces = 1000;
  // Only light with at least one more surface between its source and the first surface seen.
  bool indirect_only = false;
  bool count_first_emission = true;  // what the first surface seen shines with
  DirectStrategy strategy = DirectStrategy::mis;
};

// One estimate of the radiance in nits that arrives at the ray's origin against its direction.
Rgb trace_path(const LitScene& lit, const Ray& ray, const PathParams& params, RandomStream& random);

// One estimate of the radiance in nits that `surface` scatters towards wo: its own emission does
// not count, and for indirect_only it is the first surface seen.
Rgb trace_scattered(const LitScene& lit, const Surface& surface, const V3f& wo, const PathParams& params,
                    RandomStream& random);

// The picture of that; threads, seed and samples as in render_film(). Throws as that does.
Film render_path(const LitScene& lit, const View& view, const RenderParams& render, const PathParams& params);

}  // namespace ivory
