// The environment as a light: texels chosen by luminance times solid angle.
#pragma once

#include <vector>

#include "tracer/core/alias_table.h"
#include "tracer/lights/punctual.h"

namespace ivory {

struct EnvironmentLight {
  const EnvironmentMap* map = nullptr;
  AliasTable texels;
  // The same by inversion, which keeps neighbours together: light before each row and in all, and in each row the share
  // before each texel, times 2^32.
  std::vector<double> before_row;
  std::vector<std::uint32_t> before_texel;
  double luminance_integral = 0;   // of luminance over the sphere of directions, nits sr
  Rgb radiance_integral{0, 0, 0};  // the same per channel
};

// `map`, of at least 1 x 1 texels, must outlive the light.
EnvironmentLight make_environment_light(const EnvironmentMap& map);

// That area times the radiance integral, lumen per channel: what enters through discs of it that face each direction.
Rgb power_lm(const EnvironmentLight& light, float entry_area_m2);

// One photon, through the discs that face its direction; its power is the flux through them in the mean.
EmittedPhoton emit(const EnvironmentLight& light, const EntryDiscs& discs, RandomStream& random);
// A direction in proportion to luminance; nothing where the map is black.
std::optional<LightSample> sample(const EnvironmentLight& light, RandomStream& random);
// The same by u in [0, 1): u.x goes over the rows of texels, u.y over those of a row.
std::optional<LightSample> sample(const EnvironmentLight& light, const Imath::V2d& u);

// Directions of that density as a map from the square that keeps neighbours together: u.x goes over the rows of texels,
// u.y over those of a row.
struct SkyTable {
  std::vector<double> rows;    // light before each row, and in all
  std::vector<double> texels;  // before each texel of its row
};
SkyTable make_sky_table(const EnvironmentLight& light);
// One photon from that direction, by the point of the unit disc on one of the discs; powers as of emit() where u and
// point are even.
EmittedPhoton emit(const EnvironmentLight& light, const SkyTable& table, const Imath::V2d& u, const EntryDiscs& discs,
                   std::size_t disc, const Imath::V2d& point);

// pdf of those directions at unit w, 1/sr.
float pdf_solid_angle(const EnvironmentLight& light, const V3f& w);

}  // namespace ivory
