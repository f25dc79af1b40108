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

// `map` must outlive the light.
EnvironmentLight make_environment_light(const EnvironmentMap& map);

// pi R^2 times the radiance integral: what enters the bounding sphere.
Rgb power_lm(const EnvironmentLight& light, const BoundingSphere& sphere);

EmittedPhoton emit(const EnvironmentLight& light, const BoundingSphere& sphere, RandomStream& random);
std::optional<LightSample> sample(const EnvironmentLight& light, RandomStream& random);

// pdf of those directions, 1/sr.
float pdf_solid_angle(const EnvironmentLight& light, const V3f& w);

}  // namespace ivory
