// Direct light at a surface by next-event estimation, weighted against the rays that a caller
// sends on by the BSDF. Shared by everything that renders.
#pragma once

#include "tracer/bsdf/bsdf.h"
#include "tracer/core/lit_scene.h"

namespace ivory {

// How light that a ray can run into (emissive triangles, the environment) is estimated. Delta
// lights (point, spot, directional) can only be sampled, whatever the strategy.
enum class DirectStrategy {
  mis,    // both, by the power heuristic (Veach 1997, section 9.2)
  light,  // only by sampling lights
  bsdf,   // only by rays that run into light
};

// Radiance in nits that `surface` scatters towards wo from one sampled light, visibility included.
Rgb sample_direct(const LitScene& lit, const Surface& surface, const Bsdf& bsdf, const V3f& wo, DirectStrategy strategy,
                  RandomStream& random);

// Weights (0 to 1) of light that a ray sampled by the BSDF ran into, the complement of sample_direct(): of an emissive
// surface at `hit`, of the environment along unit w. `p` is where the ray was sampled, pdf_bsdf the density of its
// direction (1/sr).
float emission_weight(const Lights& lights, const V3f& p, const Hit& hit, float pdf_bsdf, DirectStrategy strategy);
float environment_weight(const Lights& lights, const V3f& w, float pdf_bsdf, DirectStrategy strategy);

}  // namespace ivory
