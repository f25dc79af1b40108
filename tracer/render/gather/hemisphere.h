// What arrives at a surface over its hemisphere, by rays spread evenly over its cosine, and the irradiance with its
// derivatives that follow.
#pragma once

#include <functional>
#include <vector>

#include "grid/base/types.h"
#include "tracer/core/sampler.h"
#include "tracer/core/sampling.h"

namespace ivory {

// What a ray brings.
struct GatheredLight {
  Rgb radiance{0, 0, 0};  // nits
  float inverse_m = 0;    // 1 / distance of the surface it comes from; 0: the ray met none
};

// The hemisphere is parted into rings around the normal and sectors, all cells of the same share of the cosine: ring j
// of n lies between sin^2 theta = j / n and (j + 1) / n. Derivatives are taken over coarse cells, each of which is
// parted into split x split fine ones: a derivative of one noisy ray beside the other is all noise, however many there
// are.
inline constexpr int coarse_rings = 5;
inline constexpr int coarse_sectors = 15;
struct Hemisphere {
  ShadingFrame frame;  // z is the normal
  int split = 1;
  std::vector<GatheredLight> cells;  // [ring][sector], fine ones

  int rings() const { return coarse_rings * split; }
  int sectors() const { return coarse_sectors * split; }
  const GatheredLight& at(int ring, int sector) const {
    return cells[std::size_t(ring) * std::size_t(sectors()) + std::size_t(sector)];
  }
};

// The split whose number of rays, 75 split^2, is the nearest to `rays`; at least 1.
int split_for(int rays);
inline int rays_of(int split) { return coarse_rings * coarse_sectors * split * split; }

// One ray a fine cell, at a random place in it: light(w, random) for a unit direction w.
Hemisphere gather_hemisphere(const V3f& normal, int split, RandomStream& random,
                             const std::function<GatheredLight(const V3f&, RandomStream&)>& light);

// E, the change of E with the normal and its first and second change with the place along the surface.
struct HemisphereIrradiance {
  Rgb e{0, 0, 0};                        // lux: an unbiased estimate
  V3f vector[3];                         // per channel, integral of L w dw in lux: its part along the normal is e
  V3f gradient[3];                       // per channel, lux/m along the surface
  float bend = 0;                        // largest eigenvalue of the second derivatives of luminance, absolute, lux/m^2
  float harmonic_distance_m = 0;         // harmonic mean of the rays' distances; infinite where all miss
  float free_inverse_m[coarse_sectors];  // 1 / distance along the surface to the nearest that stands on it, by sector
};
HemisphereIrradiance irradiance_of(const Hemisphere& hemisphere);

}  // namespace ivory
