// What other engines make of nine coefficients: each one's own formula on what is written for it.
#include "grid/export/dialect.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/env/moments.h"
#include "tests/grid/env/directional_light.h"

namespace ivory {
namespace {

constexpr double pi_d = 3.14159265358979323846;

// Each engine's own formula, from its documentation, on what is exported for it.
class Dialects : public testing::Test {
 protected:
  template <typename Formula>
  void expect_irradiance(Sh9Dialect dialect, double scale, Formula formula) {
    std::mt19937 random(4);
    for (int i = 0; i < 200; ++i) {
      const V3d w = random_direction(random);
      const V3d n = random_direction(random);
      const auto c = in_dialect(directional(w, V3d(7, 8, 9)), dialect);
      EXPECT_NEAR(scale * formula(c, n).y, 8 * three_bands(n.dot(w)), 1e-5);  // constants printed to six digits
    }
  }
};

// Filament's IndirectLight: coefficients hold the reconstruction factors and the 1/pi of Lambert's BRDF; the shader
// sums them times bare polynomials.
TEST_F(Dialects, Filament) {
  expect_irradiance(Sh9Dialect::filament, pi_d, [](const std::array<V3d, 9>& sh, const V3d& n) {
    return sh[0] + sh[1] * n.y + sh[2] * n.z + sh[3] * n.x + sh[4] * (n.y * n.x) + sh[5] * (n.y * n.z) +
           sh[6] * (3 * n.z * n.z - 1) + sh[7] * (n.z * n.x) + sh[8] * (n.x * n.x - n.y * n.y);
  });
  // Its table of factors: 0.282095, 0.325735, 0.273137, 0.078848, 0.136569.
  Sh9 ones;
  ones.coefficients.fill(V3d(1, 1, 1));
  const auto c = in_dialect(ones, Sh9Dialect::filament);
  const std::array<double, 9> table{0.282095, 0.325735, 0.325735, 0.325735, 0.273137,
                                    0.273137, 0.078848, 0.273137, 0.136569};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(c[i].x, table[i], 1e-6);
}

// three.js' SphericalHarmonics3.getIrradianceAt() on the nine vectors of LightProbe.sh.
TEST_F(Dialects, ThreeJs) {
  expect_irradiance(Sh9Dialect::three_js, 1, [](const std::array<V3d, 9>& sh, const V3d& n) {
    V3d e = sh[0] * 0.886227;
    e += (sh[1] * n.y + sh[2] * n.z + sh[3] * n.x) * (2 * 0.511664);
    e += (sh[4] * (n.x * n.y) + sh[5] * (n.y * n.z) + sh[7] * (n.x * n.z)) * (2 * 0.429043);
    return e + sh[6] * (0.743125 * n.z * n.z - 0.247708) + sh[8] * (0.429043 * (n.x * n.x - n.y * n.y));
  });
}

// Babylon.js: SH3ylmBasisConstants of sphericalPolynomial.ts with their signs, after
// convertIrradianceToLambertianRadiance() (times 1/pi) and preScaleForRendering(); computeEnvironmentIrradiance() of
// harmonicsFunctions.fx sums them. A point (x, y, z) of a glTF scene lies at (-x, y, z) in the left-handed world that
// it is loaded into.
V3d babylon(const std::array<V3d, 9>& sh, const V3d& n_gltf) {
  const V3d n(-n_gltf.x, n_gltf.y, n_gltf.z);
  const double p = pi_d;
  V3d e =
      sh[0] * std::sqrt(1 / (4 * p)) + sh[1] * (-std::sqrt(3 / (4 * p)) * n.y) + sh[2] * (std::sqrt(3 / (4 * p)) * n.z);
  e += sh[3] * (-std::sqrt(3 / (4 * p)) * n.x) + sh[4] * (std::sqrt(15 / (4 * p)) * n.y * n.x);
  e += sh[5] * (-std::sqrt(15 / (4 * p)) * n.y * n.z) + sh[6] * (std::sqrt(5 / (16 * p)) * (3 * n.z * n.z - 1));
  e += sh[7] * (-std::sqrt(15 / (4 * p)) * n.x * n.z) + sh[8] * (std::sqrt(15 / (16 * p)) * (n.x * n.x - n.y * n.y));
  return e / p;
}
TEST_F(Dialects, ExtLightsImageBased) { expect_irradiance(Sh9Dialect::ext_lights_image_based, pi_d, babylon); }
TEST_F(Dialects, BabylonJs) { expect_irradiance(Sh9Dialect::babylon_js, pi_d, babylon); }

// PlayCanvas: chunk lit/frag/ambient of the engine, 2.23.
TEST_F(Dialects, PlayCanvas) {
  expect_irradiance(Sh9Dialect::playcanvas, pi_d, [](const std::array<V3d, 9>& sh, const V3d& n) {
    return sh[0] + sh[1] * n.x + sh[2] * n.y + sh[3] * n.z + sh[4] * (n.x * n.z) + sh[5] * (n.z * n.y) +
           sh[6] * (n.y * n.x) + sh[7] * (3 * n.z * n.z - 1) + sh[8] * (n.x * n.x - n.y * n.y);
  });
}

// Unity: unity_SHAr, unity_SHBr, unity_SHC as SphericalHarmonicsL2 is packed into them, and ShadeSH9() of
// UnityCG.cginc. A point (x, y, z) of a glTF scene lies at (-x, y, z) in Unity's left-handed world.
TEST_F(Dialects, Unity) {
  expect_irradiance(Sh9Dialect::unity, pi_d, [](const std::array<V3d, 9>& sh, const V3d& n_gltf) {
    const V3d n(-n_gltf.x, n_gltf.y, n_gltf.z);
    V3d e = sh[3] * n.x + sh[1] * n.y + sh[2] * n.z + (sh[0] - sh[6]);
    e += sh[4] * (n.x * n.y) + sh[5] * (n.y * n.z) + sh[6] * (3 * n.z * n.z) + sh[7] * (n.z * n.x);
    return e + sh[8] * (n.x * n.x - n.y * n.y);
  });
}

TEST_F(Dialects, Names) {
  for (const Sh9Dialect dialect : values_of<Sh9Dialect>()) EXPECT_EQ(from_name<Sh9Dialect>(name_of(dialect)), dialect);
  EXPECT_THROW(from_name<Sh9Dialect>("unreal"), ParameterError);
}

}  // namespace
}  // namespace ivory
