// Point, spot and directional lights (KHR_lights_punctual).
#pragma once

#include "tracer/lights/lights.h"

namespace ivory {

// Flux in lumen per channel: 4 pi I; the spot's I integrated over its cone; E times the area that it enters through.
Rgb power_lm(const PunctualLight& light, float entry_area_m2);

// One photon, whose power is the light's flux in the mean.
EmittedPhoton emit(const PunctualLight& light, const EntryDiscs& discs, RandomStream& random);

// The same as a map from the square that keeps neighbouring directions together: of a lamp, whose photons all carry its
// flux, and through a disc's point, of a directional light.
EmittedPhoton emit(const PunctualLight& light, const Imath::V2d& u);
EmittedPhoton emit(const DirectionalLight& light, const EntryDiscs& discs, std::size_t disc, const Imath::V2d& point);

// The light as it arrives at p; nothing outside a spot's cone.
std::optional<LightSample> sample(const PunctualLight& light, const V3f& p);

}  // namespace ivory
