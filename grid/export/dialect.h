// The nine coefficients of distant light as other engines take them. Where each factor comes from is said beside it in
// dialect.cpp.
#pragma once

#include <array>

#include "grid/base/names.h"
#include "grid/env/sh9.h"

namespace ivory {

// ivory                    radiance coefficients in the all-positive basis (sh9.h)
// filament                 IndirectLight::Builder::irradiance(): E / pi, the basis' factors folded in, so that the
//                          shader sums sh[i] times 1, y, z, x, xy, yz, 3z^2 - 1, xz, x^2 - y^2
// three.js                 LightProbe, SphericalHarmonics3: the radiance coefficients as they are; getIrradianceAt()
//                          applies Ramamoorthi & Hanrahan's eq. 13
// EXT_lights_image_based   irradianceCoefficients: E_lm (their eq. 4 and 7) in the basis and the left-handed world of
//                          the one loader that reads them, Babylon.js'
// babylon.js               the same, for SphericalHarmonics.FromArray()
// playcanvas               StandardMaterial.ambientSH: filament's, in the order 1, x, y, z, xz, yz, xy, 3z^2 - 1,
//                          x^2 - y^2
// unity                    SphericalHarmonicsL2: filament's in Unity's left-handed world, where glTF importers turn x
//                          into -x
enum class Sh9Dialect { ivory, filament, three_js, ext_lights_image_based, babylon_js, playcanvas, unity };
template <>
inline constexpr auto name_table<Sh9Dialect> =
    make_name_table<Sh9Dialect>("dialect", {{Sh9Dialect::ivory, "ivory"},
                                            {Sh9Dialect::filament, "filament"},
                                            {Sh9Dialect::three_js, "three.js"},
                                            {Sh9Dialect::ext_lights_image_based, "EXT_lights_image_based"},
                                            {Sh9Dialect::babylon_js, "babylon.js"},
                                            {Sh9Dialect::playcanvas, "playcanvas"},
                                            {Sh9Dialect::unity, "unity"}});

// The nine coefficients that the dialect's reader takes, in its order, from ivory's.
std::array<V3d, 9> in_dialect(const Sh9& sh, Sh9Dialect dialect);

}  // namespace ivory
