// DifMap: the irradiance of a distant environment for every normal, unshadowed, as a cube map.
#pragma once

#include "grid/base/metadata.h"
#include "grid/env/cube_map.h"
#include "grid/env/sh9.h"

namespace ivory {

struct DifMap {
  CubeMap e;  // lux, at the texel's centre as normal
  Metadata metadata;
};

// E(n) in lux, n a unit vector: bilinear and seamless, what an OpenGL cube map with linear filtering and
// GL_TEXTURE_CUBE_MAP_SEAMLESS reads.
inline Rgb irradiance(const DifMap& map, const V3f& n) { return bilinear(map.e, n); }

// How far the nine coefficients are from `truth` (irradiance, lux) over its texels as normals, weighted by solid angle,
// each channel as read (never negative) and
//   relative to the light of the whole sphere (total_radiance, nits sr), as Ramamoorthi & Hanrahan state it, or
//   relative to the mean irradiance over all normals, a quarter of that.
// The average runs over normals and the channels that hold light; the maximum over both.
struct Sh9Error {
  double average = 0;  // of the integral of L
  double maximum = 0;
  double average_of_mean_e() const { return 4 * average; }
  double maximum_of_mean_e() const { return 4 * maximum; }
};
Sh9Error sh9_error(const Sh9& sh, const CubeMap& truth, const V3d& total_radiance);

}  // namespace ivory
