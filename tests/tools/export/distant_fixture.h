// A sky of six colours as the light to export, and the sums by which readers take E from nine coefficients.
#pragma once

#include <array>
#include <string>

#include "grid/env/sh9.h"
#include "grid/io/sh9.h"
#include "tests/support/command_test.h"
#include "tests/support/environment_pictures.h"
#include "tracer/image/file.h"

namespace ivory {

inline const std::array<V3f, 6> axes{V3f(1, 0, 0),  V3f(-1, 0, 0), V3f(0, 1, 0),
                                     V3f(0, -1, 0), V3f(0, 0, 1),  V3f(0, 0, -1)};
inline const std::array<Rgb, 6> colours{Rgb(9, 1, 1), Rgb(1, 9, 1), Rgb(1, 1, 9),
                                        Rgb(9, 9, 1), Rgb(9, 1, 9), Rgb(1, 9, 9)};

// The colour of the axis that w is nearest to.
inline Rgb six_colours(const V3d& w) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < 6; ++i)
    if (V3d(axes[i]).dot(w) > V3d(axes[best]).dot(w)) best = i;
  return colours[best];
}

using Values = std::array<V3d, 9>;
inline Values nine(const nlohmann::json& list) {
  Values out;
  EXPECT_EQ(list.size(), 9U);
  for (std::size_t i = 0; i < 9; ++i) out[i] = V3d(list[i][0], list[i][1], list[i][2]);
  return out;
}
inline Values nine_flat(const nlohmann::json& list) {
  Values out;
  EXPECT_EQ(list.size(), 27U);
  for (std::size_t i = 0; i < 9; ++i) out[i] = V3d(list[3 * i], list[3 * i + 1], list[3 * i + 2]);
  return out;
}

// Readers' sums of bare polynomials, of pre-scaled E / pi.
inline V3d prescaled(const Values& sh, const V3d& n) {
  return sh[0] + sh[1] * n.y + sh[2] * n.z + sh[3] * n.x + sh[4] * (n.x * n.y) + sh[5] * (n.y * n.z) +
         sh[6] * (3 * n.z * n.z - 1) + sh[7] * (n.x * n.z) + sh[8] * (n.x * n.x - n.y * n.y);
}
// three.js: SphericalHarmonics3.getIrradianceAt(), over pi as its materials have it. Godot's capture in
// scene_forward_clustered.glsl is the same sum with the same constants, of coefficients over pi.
inline V3d irradiance_at(const Values& sh, const V3d& n) {
  V3d e = sh[0] * 0.886227 + (sh[1] * n.y + sh[2] * n.z + sh[3] * n.x) * 1.023328;
  e += (sh[4] * (n.x * n.y) + sh[5] * (n.y * n.z) + sh[7] * (n.x * n.z)) * 0.858086;
  return e + sh[6] * (0.743125 * n.z * n.z - 0.247708) + sh[8] * (0.429043 * (n.x * n.x - n.y * n.y));
}

inline constexpr double printed = 2e-5;  // readers' constants have six digits

class ExportDistant : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    const Picture picture = make_picture(EnvironmentLayout::cube, 16, six_colours);
    Film film;
    film.width = picture.width;
    film.height = picture.height;
    film.pixels = picture.texels;
    write_image(path("sky.exr"), film, 0, {}, true);
    run("bake sh9 " + path("sky.exr") + " --order 2 -o " + path("sky.json"));
    run("bake difmap " + path("sky.exr") + " --size 32 -o " + path("difmap.exr"));
    sh_ = read_sh9(path("sky.json")).sh;
  }
  nlohmann::json export_to(const std::string& target, const std::string& output, const std::string& more = {}) const {
    return run("export " + path("sky.json") + " --to " + target + " -o " + path(output) + " " + more);
  }
  nlohmann::json json(const std::string& name) const {
    return nlohmann::json::parse(bytes_of(path(name)), nullptr, false);
  }

  // E / pi as a reader has it at the normals of a glTF world, against ivory's; and each axis is lit by its own colour.
  template <typename Reader>
  void expect_sky(const char* reader, double tolerance, const Reader& e_over_pi) const {
    for (std::size_t i = 0; i < 6; ++i) {
      const V3d n(axes[i]);
      const V3d e = e_over_pi(n);
      const V3d expected = irradiance_polynomial(sh_, n) / 3.14159265358979323846;
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(e[c] / expected[c], 1, tolerance) << reader << " axis " << i << " channel " << c;
        // Channels that the axis' colour has are brighter than those that it has not.
        for (int k = 0; k < 3; ++k) {
          if (colours[i][unsigned(c)] > colours[i][unsigned(k)]) {
            EXPECT_GT(e[c], 1.3 * e[k]) << reader << " axis " << i;
          }
        }
      }
    }
    // And between the axes.
    const V3d n = V3d(0.48, 0.64, -0.6);
    const V3d expected = irradiance_polynomial(sh_, n) / 3.14159265358979323846;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(e_over_pi(n)[c] / expected[c], 1, tolerance) << reader;
  }

  Sh9 sh_;
};

}  // namespace ivory
