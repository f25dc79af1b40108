// Emissive meshes and environments against closed forms: power, photons, irradiance, and the densities they claim.
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/env/latlong_map.h"
#include "tests/support/lights_check.h"
#include "tracer/core/alias_table.h"
#include "tracer/core/sampling.h"

namespace ivory {
namespace {

// Form factor of a rectangle a x b, parallel to the receiver at distance h, with one corner above it
// (Siegel & Howell, configuration B-4... in its usual closed form).
double corner_form_factor(double a, double b, double h) {
  const double x = a / h;
  const double y = b / h;
  const double sx = std::sqrt(1 + x * x);
  const double sy = std::sqrt(1 + y * y);
  return (x / sx * std::atan(y / sx) + y / sy * std::atan(x / sy)) / (2 * double(pi));
}

TEST(Lights, EmissiveTriangles) {
  for (const bool double_sided : {false, true}) {
    const LitScene lit = in_black_box(lamp_scene(double_sided));
    const float sides = double_sided ? 2 : 1;
    expect_power_and_photons_agree(lit.lights, Rgb(10, 5, 1) * (pi * 3 * sides), "quad");
    const double truth = 10 * double(pi) * corner_form_factor(1, 3, 2);
    const Accumulator below = irradiance_samples(lit.lights, {0, 0, 0}, {0, 1, 0}, 200000);
    EXPECT_LT(std::abs(z_score(below, truth)), z_limit);
    const Accumulator above = irradiance_samples(lit.lights, {0, 4, 0}, {0, -1, 0}, 200000);
    if (double_sided) {
      EXPECT_LT(std::abs(z_score(above, truth)), z_limit);
    } else {
      EXPECT_EQ(above.mean(), 0);
    }
    RandomStream random = test_stream();
    int up = 0;
    for (int i = 0; i < 10000; ++i) up += lit.lights.emit(random).direction.y > 0 ? 1 : 0;
    EXPECT_NEAR(up, double_sided ? 5000 : 0, double_sided ? 200 : 0);  // 4 standard deviations of a fair coin
  }
}

// A mirroring transform turns the winding round; glTF's front stays where the mirrored front is.
TEST(Lights, EmissiveTrianglesKeepTheirSideWhenMirrored) {
  M44f mirror;
  mirror.setScale(V3f(-1, 1, 1));
  for (const int copies : {1, 2}) {  // placed twice it is an Embree instance
    Scene scene = lamp_scene(false, mirror);
    if (copies == 2) {
      Instance far = scene.instances[0];
      far.to_world[3][0] = 1000;
      scene.instances.push_back(far);
    }
    const LitScene lit = in_black_box(std::move(scene));
    const Accumulator below = irradiance_samples(lit.lights, {0, 0, 0}, {0, 1, 0}, 200000);
    const double truth = 10 * double(pi) * corner_form_factor(1, 3, 2);
    // The second lamp, a kilometre away, adds less than 1e-6 of it.
    EXPECT_LT(std::abs(z_score(below, truth)), z_limit);
    Ray up;
    up.origin = V3f(-0.5F, 0, 1);
    up.direction = V3f(0, 1, 0);
    const auto hit = lit.intersector.closest(up);
    ASSERT_TRUE(hit);
    EXPECT_GT(lit.lights.pdf_solid_angle(up.origin, *hit), 0);
    up.origin.y = 4;
    up.direction.y = -1;
    const auto back = lit.intersector.closest(up);
    ASSERT_TRUE(back);
    EXPECT_EQ(lit.lights.pdf_solid_angle(up.origin, *back), 0);
  }
}

// An emission texture whose four columns are black, white, black, white in red averages to 1/2 there.
TEST(Lights, TexturedEmission) {
  Scene scene = lamp_scene(false);
  Image image;
  image.width = 4;
  image.height = 1;
  image.rgba = {0, 255, 255, 255, 255, 255, 255, 255, 0, 255, 255, 255, 255, 255, 255, 255};
  scene.images.push_back(image);
  Texture texture;
  texture.image = 0;
  texture.nearest = true;
  scene.textures.push_back(texture);
  scene.materials[0].emission_texture.texture = 0;
  const LitScene lit = in_black_box(std::move(scene));
  const Rgb power = lit.lights.total_power_lm();
  EXPECT_NEAR(power.x, 10 * pi * 3 * 0.5F, 1e-5F * 10 * pi * 3);
  EXPECT_NEAR(power.y, 5 * pi * 3, 1e-4F * power.y);
  RandomStream random = test_stream();
  Accumulator mean;
  for (int i = 0; i < 200000; ++i) mean.add(double(lit.lights.emit(random).power.x));
  EXPECT_LT(std::abs(z_score(mean, double(10 * pi * 3 * 0.5F))), z_limit);
}

TEST(Lights, TriangleDensityMatchesItsSamples) {
  Scene scene = lamp_scene(true);
  scene.lights.push_back(point_at({5, 5, 5}, {3, 3, 3}));
  const LitScene lit = in_black_box(std::move(scene));
  RandomStream random = test_stream();
  int checked = 0;
  for (int i = 0; i < 1000; ++i) {
    const V3f p = sample_sphere(random.next2()) * 1.5F;
    const auto s = lit.lights.sample(p, random);
    if (!s || s->delta) continue;
    Ray ray;
    ray.origin = p;
    ray.direction = s->w;
    const auto hit = lit.intersector.closest(ray);
    if (!hit) continue;  // a sample on the very edge
    // Both come from the same formula; the hit point is rounded differently, which grazing angles amplify.
    EXPECT_NEAR(lit.lights.pdf_solid_angle(p, *hit), s->pdf_solid_angle, 1e-3F * s->pdf_solid_angle);
    EXPECT_NEAR(hit->t, s->distance_m, 1e-4F * s->distance_m);
    ++checked;
  }
  EXPECT_GT(checked, 600);  // three quarters of the power is the lamp's
}

TEST(Lights, UniformEnvironmentGivesPiL) {
  Scene scene;
  scene.environment = uniform_environment({3, 2, 1});
  const LitScene lit = in_black_box(std::move(scene));
  for (const V3f& n : {V3f(0, 1, 0), V3f(1, 0, 0), V3f(-1, -2, 3).normalized()}) {
    const Accumulator e = irradiance_samples(lit.lights, {0, 0, 0}, n, 200000);
    EXPECT_LT(std::abs(z_score(e, 3 * double(pi))), z_limit);
  }
  EXPECT_NEAR(lit.lights.environment_pdf_solid_angle(V3f(0, 1, 0)), 1 / (4 * pi), 1e-6F);
  const float radius = lit.intersector.radius_m();
  expect_power_and_photons_agree(lit.lights, Rgb(3, 2, 1) * (4 * pi * pi * radius * radius), "environment");
}

TEST(Lights, EnvironmentTexelsLieWhereTheConventionSays) {
  EnvironmentMap map = uniform_environment({0, 0, 0}, 16);
  const auto set = [&](int column, int row, float value) {
    map.radiance[std::size_t(row * map.width + column)] = Rgb(value, value, value);
  };
  set(16, 8, 1);  // right of the centre, below the horizon: +Z, slightly to -X and down
  set(24, 8, 2);  // three quarters: -X
  set(8, 8, 3);   // one quarter: +X
  set(0, 8, 4);   // left edge: -Z
  set(5, 0, 5);   // top row: +Y
  set(5, 15, 6);  // bottom row: -Y
  const float d = 0.01F;
  EXPECT_EQ(eval(map, V3f(-d, -d, 1).normalized()).x, 1);
  EXPECT_EQ(eval(map, V3f(-1, -d, -d).normalized()).x, 2);
  EXPECT_EQ(eval(map, V3f(1, -d, d).normalized()).x, 3);
  EXPECT_EQ(eval(map, V3f(d, -d, -1).normalized()).x, 4);
  const float azimuth = 2 * pi * (5.5F / 32 - 0.5F);
  EXPECT_EQ(eval(map, V3f(-d * std::sin(azimuth), 1, d * std::cos(azimuth)).normalized()).x, 5);
  EXPECT_EQ(eval(map, V3f(-d * std::sin(azimuth), -1, d * std::cos(azimuth)).normalized()).x, 6);
}

TEST(Lights, EnvironmentSamplesMatchTheirDensity) {
  Scene scene;
  EnvironmentMap map = uniform_environment({1, 1, 1}, 8);
  for (std::size_t i = 0; i < map.radiance.size(); ++i) map.radiance[i] = Rgb(1, 0.5F, 0) * float((i * 7) % 11);
  scene.environment = map;
  const LitScene lit = in_black_box(std::move(scene));
  RandomStream random = test_stream();
  // Bins of a texel each; the density is constant within, so density times solid angle is exact.
  std::vector<double> counts(map.radiance.size(), 0);
  std::vector<double> expected(map.radiance.size(), 0);
  constexpr int samples = 200000;
  double total = 0;
  for (int i = 0; i < samples; ++i) {
    const auto s = lit.lights.sample({0, 0, 0}, random);
    ASSERT_TRUE(s);
    ASSERT_EQ(s->pdf_solid_angle, lit.lights.environment_pdf_solid_angle(s->w));
    ASSERT_EQ(s->irradiance_weight, lit.lights.environment_radiance(s->w) / s->pdf_solid_angle);
    const int row = std::clamp(int(std::acos(double(s->w.y)) / double(pi) * 8), 0, 7);
    const int column =
        std::clamp(int((0.5 + std::atan2(double(-s->w.x), double(s->w.z)) / (2 * double(pi))) * 16), 0, 15);
    counts[std::size_t(row * 16 + column)] += 1;
  }
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 16; ++column) {
      const double solid_angle =
          2 * double(pi) / 16 * (std::cos(row * double(pi) / 8) - std::cos((row + 1) * double(pi) / 8));
      const double polar = (row + 0.5) * double(pi) / 8;
      const double azimuth = 2 * double(pi) * ((column + 0.5) / 16 - 0.5);
      const V3f w(float(-std::sin(polar) * std::sin(azimuth)), float(std::cos(polar)),
                  float(std::sin(polar) * std::cos(azimuth)));
      const double mass = double(lit.lights.environment_pdf_solid_angle(w)) * solid_angle;
      expected[std::size_t(row * 16 + column)] = mass * samples;
      total += mass;
    }
  }
  EXPECT_NEAR(total, 1, 1e-5);
  EXPECT_LT(chi_square_score(counts, expected), 4.0);
}

TEST(Lights, ZeroAreaEmittersAreLeftOut) {
  Scene scene;
  const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(1, 1, 1));
  add_mesh(scene, make_quad({0, 0, 0}, {1, 0, 0}, {2, 0, 0}, lamp));
  const LitScene lit = in_black_box(std::move(scene));
  EXPECT_TRUE(lit.lights.empty());
}

}  // namespace
}  // namespace ivory
