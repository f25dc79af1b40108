// Nine coefficients of distant light as small JSON files for other engines.
#pragma once

#include <string>

#include "grid/export/dialect.h"
#include "grid/io/sh9.h"

namespace ivory {

// What the dialect's reader takes:
//   ivory                   write_sh9()
//   filament                {"irradiance": 9 x 3}, for IndirectLight::Builder::irradiance(3, ...)
//   three.js                an object of ObjectLoader's with a LightProbe, whose type, intensity and 27 numbers "sh"
//                           stand at the top too
//   EXT_lights_image_based  {"intensity": 1, "irradianceCoefficients": 9 x 3}, for the extension's light
//   babylon.js              {"irradianceCoefficients": 9 x 3}, for SphericalHarmonics.FromArray()
//   playcanvas              {"ambientSH": 27 numbers}
//   unity                   {"sh": 27 numbers: 9 of red, of green, of blue}, for SphericalHarmonicsL2
// all with an "extras" object that says where they come from and how they are used. Throws as write_sh9 does.
void write_sh9_dialect(const std::string& path, const Sh9Asset& asset, Sh9Dialect dialect, bool force);

}  // namespace ivory
