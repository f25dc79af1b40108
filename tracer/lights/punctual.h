// Point, spot and directional lights (KHR_lights_punctual).
#pragma once

#include "tracer/lights/lights.h"

namespace ivory {

// Flux in lumen per channel: 4 pi I; the spot's I integrated over its cone; E times the area that it enters through.
Rgb power_lm(const PunctualLight& light, float entry_area_m2);

// One photon, whose power is the light's flux in the mean.
EmittedPhoton emit(const PunctualLight& light, const EntryDiscs& discs, RandomStream& random);

// The light as it arrives at p; nothing outside a spot's cone.
std::optional<LightSample> sample(const PunctualLight& light, const V3f& p);

}  // namespace ivory
