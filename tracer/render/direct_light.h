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

struct DirectSampling {
  DirectSampling(DirectStrategy by, LightPick lights = LightPick::one, float share = 1)
      : strategy(by), pick(lights), bsdf_share(share) {}

  DirectStrategy strategy;
  LightPick pick;
  // Of how many of the surfaces, in the mean, the caller sends on a ray by the BSDF, whose light it divides by that: 0
  // (of none) to 1 (of each).
  float bsdf_share;
};

// Where a surface asks for light.
inline Receiver receiver_at(const Surface& surface) { return {surface.p, surface.ns}; }

// Radiance in nits that `surface` scatters towards wo from sampled lights, visibility included.
Rgb sample_direct(const LitScene& lit, const Surface& surface, const Bsdf& bsdf, const V3f& wo,
                  const DirectSampling& sampling, RandomStream& random);

// Weights (0 to 1) of light that a ray sampled by the BSDF ran into, the complement of sample_direct() of the same
// sampling: of an emissive surface at `hit`, of the environment along unit w. `from` is where the ray was sampled,
// pdf_bsdf the density of its direction (1/sr).
float emission_weight(const Lights& lights, const Receiver& from, const Hit& hit, float pdf_bsdf,
                      const DirectSampling& sampling);
float environment_weight(const Lights& lights, const Receiver& from, const V3f& w, float pdf_bsdf,
                         const DirectSampling& sampling);

}  // namespace ivory
