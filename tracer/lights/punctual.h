// Point, spot and directional lights (KHR_lights_punctual).
#pragma once

#include "tracer/lights/lights.h"

namespace ivory {

// Directional and environment light enter a scene through a disc over this sphere.
struct BoundingSphere {
  V3f center;
  float radius_m = 1;
};

// Flux in lumen per channel: 4 pi I; the spot's I integrated over its cone; pi R^2 E.
Rgb power_lm(const PunctualLight& light, const BoundingSphere& sphere);

// One photon, whose power is the light's flux.
EmittedPhoton emit(const PunctualLight& light, const BoundingSphere& sphere, RandomStream& random);

// The light as it arrives at p; nothing outside a spot's cone.
std::optional<LightSample> sample(const PunctualLight& light, const V3f& p);

}  // namespace ivory
