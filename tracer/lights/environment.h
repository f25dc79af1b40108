// The environment as a light: texels chosen by luminance times solid angle.
#pragma once

#include "tracer/core/alias_table.h"
#include "tracer/lights/punctual.h"

namespace ivory {

struct EnvironmentLight {
  const EnvironmentMap* map = nullptr;
  AliasTable texels;
  double luminance_integral = 0;   // of luminance over the sphere of directions, nits sr
  Rgb radiance_integral{0, 0, 0};  // the same per channel
};

// `map`, of at least 1 x 1 texels, must outlive the light.
EnvironmentLight make_environment_light(const EnvironmentMap& map);

// pi R^2 times the radiance integral, lumen per channel: what enters the bounding sphere.
Rgb power_lm(const EnvironmentLight& light, const BoundingSphere& sphere);

// One photon, from the disc over the sphere that faces its direction; its power is power_lm() in the mean.
EmittedPhoton emit(const EnvironmentLight& light, const BoundingSphere& sphere, RandomStream& random);
// A direction in proportion to luminance; nothing where the map is black.
std::optional<LightSample> sample(const EnvironmentLight& light, RandomStream& random);

// pdf of those directions at unit w, 1/sr.
float pdf_solid_angle(const EnvironmentLight& light, const V3f& w);

}  // namespace ivory
