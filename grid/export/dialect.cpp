#include "grid/export/dialect.h"

#include <numbers>

namespace ivory {

namespace {

// Functions that change sign when x does: what a world mirrored in x takes with the other sign.
constexpr std::array<double, 9> mirrored_x{1, 1, 1, -1, -1, 1, 1, -1, 1};

// Babylon.js evaluates a basis with the signs of the Condon-Shortley phase: SH3ylmBasisConstants of its
// sphericalPolynomial.ts.
constexpr std::array<double, 9> babylon_basis{1, -1, 1, -1, 1, -1, 1, -1, 1};

// Where ivory's functions stand in PlayCanvas' list: litForwardPost's ambientSH sums 1, x, y, z, xz, zy, yx, 3z^2 - 1,
// x^2 - y^2.
constexpr std::array<std::size_t, 9> playcanvas_order{0, 3, 1, 2, 7, 5, 4, 6, 8};

}  // namespace

std::array<V3d, 9> in_dialect(const Sh9& sh, Sh9Dialect dialect) {
  std::array<V3d, 9> out = sh.coefficients;
  // Lambert's outgoing radiance over albedo, E / pi, as a sum of bare polynomials: A_i L_i K_i / pi.
  const auto prescaled = [&](std::size_t i) {
    return sh.coefficients[i] * (sh9_cosine[i] * sh9_factor[i] / std::numbers::pi);
  };
  for (std::size_t i = 0; i < 9; ++i) {
    switch (dialect) {
      case Sh9Dialect::ivory:
      case Sh9Dialect::three_js:  // applies A and K itself, and its materials divide by pi
        break;
      case Sh9Dialect::filament:
        out[i] = prescaled(i);
        break;
      case Sh9Dialect::playcanvas:
        out[i] = prescaled(playcanvas_order[i]);
        break;
      case Sh9Dialect::unity:
        out[i] = prescaled(i) * mirrored_x[i];
        break;
      case Sh9Dialect::ext_lights_image_based:
      case Sh9Dialect::babylon_js:
        // E_lm, which the loader divides by pi. A glTF scene's root turns (x, y, z) into (-x, y, z) in Babylon's
        // default, left-handed scene (rotation [0 1 0 0], scaling [1 1 -1]), and the harmonics are evaluated at that
        // world's normals.
        out[i] = sh.coefficients[i] * (sh9_cosine[i] * babylon_basis[i] * mirrored_x[i]);
        break;
    }
  }
  return out;
}

}  // namespace ivory
