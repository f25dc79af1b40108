// Every kind of light against closed forms: its power, the photons it emits, the irradiance it
// gives to a point, and the densities it claims.
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grid/error.h"
#include "tests/statistics.h"
#include "tools/stability/scene_builder.h"
#include "tracer/alias_table.h"
#include "tracer/environment.h"
#include "tracer/lights.h"
#include "tracer/sampling.h"

namespace ivory {
namespace {

RandomStream test_stream(std::uint64_t index = 0) { return {1, StreamPurpose::test, index}; }

// Keeps what Lights refers to alive. A black box far away gives the scene a bounding sphere without
// standing in the light's way.
struct Lit {
  Scene scene;
  std::unique_ptr<Intersector> intersector;
  std::unique_ptr<Lights> lights;

  explicit Lit(Scene s) : scene(std::move(s)) {
    if (scene.instances.empty()) {
      const int black = add_lambert(scene, Rgb(0, 0, 0));
      add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), black));
    }
    intersector = std::make_unique<Intersector>(scene);
    lights = std::make_unique<Lights>(scene, *intersector);
  }
};

// E(p, n) by sampling lights, without occlusion.
Accumulator irradiance_samples(const Lights& lights, const V3f& p, const V3f& n, int count) {
  RandomStream random = test_stream();
  Accumulator e;
  for (int i = 0; i < count; ++i) {
    const auto s = lights.sample(p, random);
    e.add(s ? double(s->irradiance_weight.x * std::max(0.0F, s->w.dot(n))) : 0.0);
  }
  return e;
}

void expect_power_and_photons_agree(const Lights& lights, const Rgb& power_lm, const std::string& label) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(lights.total_power_lm()[c], power_lm[c], 1e-5F * power_lm[c]) << label;  // float rounding
  RandomStream random = test_stream();
  Accumulator mean;
  for (int i = 0; i < 100000; ++i) {
    const EmittedPhoton photon = lights.emit(random);
    ASSERT_NEAR(photon.direction.length(), 1, 1e-5F);
    mean.add(double(photon.power.x));
  }
  EXPECT_LT(std::abs(z_score(mean, double(power_lm.x))), z_limit) << label;
}

PointLight point_at(const V3f& p, const Rgb& intensity) { return {p, intensity}; }

TEST(AliasTable, ChoosesInProportionToWeights) {
  std::vector<double> weights;
  for (int i = 0; i < 100; ++i) weights.push_back(i % 7 == 0 ? 0.0 : i * i);
  const AliasTable table(weights);
  RandomStream random = test_stream();
  std::vector<double> counts(weights.size(), 0);
  std::vector<double> expected;
  constexpr int samples = 1000000;
  for (int i = 0; i < samples; ++i) counts[table.sample(random)] += 1;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    expected.push_back(weights[i] / table.total() * samples);
    if (weights[i] == 0) {
      EXPECT_EQ(counts[i], 0);
    }
  }
  EXPECT_LT(chi_square_score(counts, expected), 4.0);  // one-sided: once in 31,000
  EXPECT_TRUE(AliasTable(std::vector<double>{0, 0}).empty());
  EXPECT_TRUE(AliasTable(std::vector<double>{}).empty());
}

TEST(Lights, PointLight) {
  Scene scene;
  scene.lights.push_back(point_at({0.1F, 0.2F, 0.3F}, {2, 1, 0.5F}));
  const Lit lit(std::move(scene));
  expect_power_and_photons_agree(*lit.lights, Rgb(2, 1, 0.5F) * (4 * pi), "point");
  const auto e = irradiance_samples(*lit.lights, {0.1F, 0.2F, 2.3F}, {0, 0, -1}, 10);
  EXPECT_NEAR(e.mean(), 2.0 / 4.0, 1e-6);
}

TEST(Lights, SpotLight) {
  struct Cone {
    float inner, outer;
  };
  for (const Cone cone : {Cone{0.2F, 0.7F}, Cone{0, pi / 2}, Cone{0.5F, 0.5F}, Cone{0, 0.02F}}) {
    SpotLight spot;
    spot.position = V3f(0, 0, 0);
    spot.direction = V3f(1, -2, 0.5F).normalized();
    spot.intensity_cd = Rgb(3, 3, 3);
    spot.inner_angle_rad = cone.inner;
    spot.outer_angle_rad = cone.outer;
    // Flux by quadrature of the specification's own formula.
    const double width = std::max(0.001, std::cos(double(cone.inner)) - std::cos(double(cone.outer)));
    double sum = 0;
    constexpr int steps = 200000;
    for (int i = 0; i < steps; ++i) {
      const double cosine = 1 - 2 * (i + 0.5) / steps;
      const double a = std::clamp((cosine - std::cos(double(cone.outer))) / width, 0.0, 1.0);
      sum += a * a;
    }
    const float flux = float(3 * 2 * double(pi) * sum * 2 / steps);
    Scene scene;
    scene.lights.push_back(spot);
    const Lit lit(std::move(scene));
    const Rgb power = lit.lights->total_power_lm();
    // The quadrature has 2e5 steps over [-1, 1]: the narrowest cone covers 20 of them.
    EXPECT_NEAR(power.x, flux, (cone.outer < 0.1F ? 0.02F : 1e-4F) * flux);
    expect_power_and_photons_agree(*lit.lights, power, "spot");

    // Photons spread as the intensity does: flux counted in rings of equal cosine.
    RandomStream random = test_stream();
    constexpr int rings = 20;
    constexpr int photons = 200000;
    std::vector<double> counts(rings, 0);
    std::vector<double> expected(rings, 0);
    const double lowest = std::cos(double(cone.outer));
    for (int i = 0; i < photons; ++i) {
      const double cosine = double(lit.lights->emit(random).direction.dot(spot.direction));
      const double ring = std::floor((cosine - lowest) / (1 - lowest) * rings);
      counts[std::size_t(std::clamp(ring, 0.0, rings - 1.0))] += 1;
    }
    double total = 0;
    constexpr int fine = 10000;
    for (int i = 0; i < rings * fine; ++i) {
      const double cosine = lowest + (1 - lowest) * (i + 0.5) / (rings * fine);
      const double a = std::clamp((cosine - lowest) / width, 0.0, 1.0);
      expected[std::size_t(i / fine)] += a * a;
      total += a * a;
    }
    for (double& x : expected) x *= photons / total;
    // A cone of 0.02 rad spans 3,000 float steps in cosine only: rounding alone shifts counts there.
    if (cone.outer > 0.1F) {
      EXPECT_LT(chi_square_score(counts, expected), 4.0) << cone.outer;
    }

    // On the axis and half way between the angles.
    const V3f p = spot.direction * 2;
    const double expected_e = 3.0 / 4 * std::pow(std::min(1.0, (1 - lowest) / width), 2);
    // A float cosine near 1 is good to 6e-8, of a zone that may be only 0.001 wide.
    EXPECT_NEAR(irradiance_samples(*lit.lights, p, -spot.direction, 4).mean(), expected_e, 1e-3 * expected_e);
    const V3f outside = make_frame(spot.direction).to_world(direction_at_cosine(std::cos(cone.outer + 0.01F), 0.3F));
    EXPECT_FALSE(lit.lights->sample(outside, random));
  }
}

TEST(Lights, DirectionalLight) {
  Scene scene;
  const V3f direction = V3f(1, -3, 2).normalized();
  scene.lights.push_back(DirectionalLight{direction, Rgb(5, 5, 5)});
  const Lit lit(std::move(scene));
  const float radius = lit.intersector->radius_m();
  expect_power_and_photons_agree(*lit.lights, Rgb(5, 5, 5) * (pi * radius * radius), "directional");
  const V3f n = V3f(0, 1, 0);
  EXPECT_NEAR(irradiance_samples(*lit.lights, {0, 0, 0}, n, 4).mean(), 5.0 * double(-direction.dot(n)), 1e-5);
}

// Photons through a disc inside the sphere, per area and per photon, are E whatever the disc's direction.
double flux_per_area(const Lights& lights, const V3f& center, const V3f& n, float radius, Accumulator& samples) {
  RandomStream random = test_stream(7);
  for (int i = 0; i < 1000000; ++i) {
    const EmittedPhoton photon = lights.emit(random);
    const float cosine = photon.direction.dot(n);
    double flux = 0;
    if (cosine < 0) {
      const float t = (center - photon.origin).dot(n) / cosine;
      if (t > 0 && (photon.origin + photon.direction * t - center).length() < radius) flux = double(photon.power.x);
    }
    samples.add(flux / double(pi * radius * radius));
  }
  return samples.mean();
}

TEST(Lights, PhotonsCrossADiscAsIrradianceSays) {
  const V3f p(0.1F, -0.2F, 0.05F);
  const V3f n = V3f(0.3F, 1, 0.2F).normalized();
  struct Source {
    const char* name;
    std::function<void(Scene&)> add;
  };
  const std::vector<Source> sources{
      // Far away compared with the disc's radius, so that E at its centre is E over it within 0.1 %.
      {"point",
       [](Scene& s) {
         s.lights.push_back(point_at({1, 4, 0}, {100, 100, 100}));
       }},
      {"spot",
       [](Scene& s) {
         s.lights.push_back(SpotLight{{0, 4, 1}, V3f(0, -1, -0.2F).normalized(), {100, 100, 100}, 0.3F, 0.6F});
       }},
      {"directional",
       [](Scene& s) {
         s.lights.push_back(DirectionalLight{V3f(-1, -2, 0.3F).normalized(), {5, 5, 5}});
       }},
      {"environment",
       [](Scene& s) {
         EnvironmentMap map = uniform_environment({1, 1, 1}, 16);
         for (std::size_t i = 0; i < map.radiance.size(); ++i) map.radiance[i] *= float(i % 37);
         s.environment = map;
       }},
      {"triangles",
       [](Scene& s) {
         const int lamp = add_lambert(s, Rgb(0, 0, 0), Rgb(50, 50, 50));
         add_mesh(s, make_quad({-0.5F, 3, -0.5F}, {1, 0, 0}, {0, 0, 1}, lamp));  // looks down
       }},
  };
  for (const Source& source : sources) {
    Scene scene;
    const int black = add_lambert(scene, Rgb(0, 0, 0));
    add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), black));
    source.add(scene);
    const Lit lit(std::move(scene));
    Accumulator photons;
    flux_per_area(*lit.lights, p, n, 0.15F, photons);
    const Accumulator e = irradiance_samples(*lit.lights, p, n, 400000);
    EXPECT_GT(e.mean(), 0);
    // 0.2 % for the variation of E over the disc.
    const double error = std::hypot(photons.standard_error(), e.standard_error());
    EXPECT_LT(std::abs(photons.mean() - e.mean()), z_limit * error + 2e-3 * e.mean()) << source.name;
  }
}

// Form factor of a rectangle a x b, parallel to the receiver at distance h, with one corner above it
// (Siegel & Howell, configuration B-4... in its usual closed form).
double corner_form_factor(double a, double b, double h) {
  const double x = a / h;
  const double y = b / h;
  const double sx = std::sqrt(1 + x * x);
  const double sy = std::sqrt(1 + y * y);
  return (x / sx * std::atan(y / sx) + y / sy * std::atan(x / sy)) / (2 * double(pi));
}

Scene lamp_scene(bool double_sided, const M44f& to_world = M44f()) {
  Scene scene;
  const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(10, 5, 1), double_sided);
  add_mesh(scene, make_quad({0, 2, 0}, {1, 0, 0}, {0, 0, 3}, lamp), to_world);  // front looks down
  return scene;
}

TEST(Lights, EmissiveTriangles) {
  for (const bool double_sided : {false, true}) {
    const Lit lit(lamp_scene(double_sided));
    const float sides = double_sided ? 2 : 1;
    expect_power_and_photons_agree(*lit.lights, Rgb(10, 5, 1) * (pi * 3 * sides), "quad");
    const double truth = 10 * double(pi) * corner_form_factor(1, 3, 2);
    const Accumulator below = irradiance_samples(*lit.lights, {0, 0, 0}, {0, 1, 0}, 200000);
    EXPECT_LT(std::abs(z_score(below, truth)), z_limit);
    const Accumulator above = irradiance_samples(*lit.lights, {0, 4, 0}, {0, -1, 0}, 200000);
    if (double_sided) {
      EXPECT_LT(std::abs(z_score(above, truth)), z_limit);
    } else {
      EXPECT_EQ(above.mean(), 0);
    }
    RandomStream random = test_stream();
    int up = 0;
    for (int i = 0; i < 10000; ++i) up += lit.lights->emit(random).direction.y > 0 ? 1 : 0;
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
    const Lit lit(std::move(scene));
    const Accumulator below = irradiance_samples(*lit.lights, {0, 0, 0}, {0, 1, 0}, 200000);
    const double truth = 10 * double(pi) * corner_form_factor(1, 3, 2);
    // The second lamp, a kilometre away, adds less than 1e-6 of it.
    EXPECT_LT(std::abs(z_score(below, truth)), z_limit);
    Ray up;
    up.origin = V3f(-0.5F, 0, 1);
    up.direction = V3f(0, 1, 0);
    const auto hit = lit.intersector->closest(up);
    ASSERT_TRUE(hit);
    EXPECT_GT(lit.lights->pdf_solid_angle(up.origin, *hit), 0);
    up.origin.y = 4;
    up.direction.y = -1;
    const auto back = lit.intersector->closest(up);
    ASSERT_TRUE(back);
    EXPECT_EQ(lit.lights->pdf_solid_angle(up.origin, *back), 0);
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
  const Lit lit(std::move(scene));
  const Rgb power = lit.lights->total_power_lm();
  // The quadrature has 4 steps an edge and cells that texel edges cut: 5 % of the power, which only guides
  // the choice among lights. Green is untextured.
  EXPECT_NEAR(power.x, 10 * pi * 3 * 0.5F, 0.05F * 10 * pi * 3);
  EXPECT_NEAR(power.y, 5 * pi * 3, 1e-4F * power.y);
  // Estimators do not rest on the quadrature.
  RandomStream random = test_stream();
  Accumulator mean;
  for (int i = 0; i < 200000; ++i) mean.add(double(lit.lights->emit(random).power.x));
  EXPECT_LT(std::abs(z_score(mean, double(10 * pi * 3 * 0.5F))), z_limit);
}

TEST(Lights, TriangleDensityMatchesItsSamples) {
  Scene scene = lamp_scene(true);
  scene.lights.push_back(point_at({5, 5, 5}, {3, 3, 3}));
  const Lit lit(std::move(scene));
  RandomStream random = test_stream();
  int checked = 0;
  for (int i = 0; i < 1000; ++i) {
    const V3f p = sample_sphere(random.next2()) * 1.5F;
    const auto s = lit.lights->sample(p, random);
    if (!s || s->delta) continue;
    Ray ray;
    ray.origin = p;
    ray.direction = s->w;
    const auto hit = lit.intersector->closest(ray);
    if (!hit) continue;  // a sample on the very edge
    // Both come from the same formula; the hit point is rounded differently, which grazing angles amplify.
    EXPECT_NEAR(lit.lights->pdf_solid_angle(p, *hit), s->pdf_solid_angle, 1e-3F * s->pdf_solid_angle);
    EXPECT_NEAR(hit->t, s->distance_m, 1e-4F * s->distance_m);
    ++checked;
  }
  EXPECT_GT(checked, 600);  // three quarters of the power is the lamp's
}

TEST(Lights, UniformEnvironmentGivesPiL) {
  Scene scene;
  scene.environment = uniform_environment({3, 2, 1});
  const Lit lit(std::move(scene));
  for (const V3f& n : {V3f(0, 1, 0), V3f(1, 0, 0), V3f(-1, -2, 3).normalized()}) {
    const Accumulator e = irradiance_samples(*lit.lights, {0, 0, 0}, n, 200000);
    EXPECT_LT(std::abs(z_score(e, 3 * double(pi))), z_limit);
  }
  EXPECT_NEAR(lit.lights->environment_pdf_solid_angle(V3f(0, 1, 0)), 1 / (4 * pi), 1e-6F);
  const float radius = lit.intersector->radius_m();
  expect_power_and_photons_agree(*lit.lights, Rgb(3, 2, 1) * (4 * pi * pi * radius * radius), "environment");
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
  const Lit lit(std::move(scene));
  RandomStream random = test_stream();
  // Bins of a texel each; the density is constant within, so density times solid angle is exact.
  std::vector<double> counts(map.radiance.size(), 0);
  std::vector<double> expected(map.radiance.size(), 0);
  constexpr int samples = 200000;
  double total = 0;
  for (int i = 0; i < samples; ++i) {
    const auto s = lit.lights->sample({0, 0, 0}, random);
    ASSERT_TRUE(s);
    ASSERT_EQ(s->pdf_solid_angle, lit.lights->environment_pdf_solid_angle(s->w));
    ASSERT_EQ(s->irradiance_weight, lit.lights->environment_radiance(s->w) / s->pdf_solid_angle);
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
      const double mass = double(lit.lights->environment_pdf_solid_angle(w)) * solid_angle;
      expected[std::size_t(row * 16 + column)] = mass * samples;
      total += mass;
    }
  }
  EXPECT_NEAR(total, 1, 1e-5);
  EXPECT_LT(chi_square_score(counts, expected), 4.0);
}

TEST(Lights, ArePickedInProportionToPower) {
  Scene scene;
  scene.lights.push_back(point_at({0, 0, 2}, {9, 9, 9}));
  scene.lights.push_back(point_at({0, 2, 0}, {1, 1, 1}));
  scene.lights.push_back(point_at({2, 0, 0}, {0, 0, 1e-3F}));  // a speck of blue must not be forgotten
  const Lit lit(std::move(scene));
  RandomStream random = test_stream();
  Accumulator from_z;
  Accumulator blue;
  for (int i = 0; i < 1000000; ++i) {
    const auto s = lit.lights->sample({0, 0, 0}, random);
    from_z.add(s->w.z > 0.5F ? 1 : 0);
    blue.add(s->w.x > 0.5F ? double(s->irradiance_weight.z) : 0);
  }
  EXPECT_LT(std::abs(z_score(from_z, 9 / (10 + 0.0722e-3))), z_limit);
  EXPECT_LT(std::abs(z_score(blue, 1e-3 / 4)), z_limit);
}

TEST(Lights, PhotonsCarryLevelLuminance) {
  Scene scene = lamp_scene(false);
  scene.lights.push_back(point_at({0, 0, 2}, {0, 0, 7}));
  scene.lights.push_back(DirectionalLight{V3f(0, -1, 0), Rgb(1, 0, 0)});
  scene.environment = uniform_environment({0.1F, 0.5F, 0.2F});
  const Lit lit(std::move(scene));
  RandomStream random = test_stream();
  const float total = luminance(lit.lights->total_power_lm());
  for (int i = 0; i < 10000; ++i) ASSERT_NEAR(luminance(lit.lights->emit(random).power), total, 1e-4F * total);
}

TEST(Lights, DarkScenesHaveNone) {
  Scene scene;
  const int grey = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), grey));
  scene.lights.push_back(point_at({0, 0, 0}, {0, 0, 0}));
  scene.environment = uniform_environment({0, 0, 0});
  const Lit lit(std::move(scene));
  RandomStream random = test_stream();
  EXPECT_TRUE(lit.lights->empty());
  EXPECT_FALSE(lit.lights->has_extended());
  EXPECT_FALSE(lit.lights->sample({0, 0, 0}, random));
  EXPECT_EQ(lit.lights->emit(random).power, Rgb(0, 0, 0));
  EXPECT_EQ(lit.lights->environment_pdf_solid_angle({0, 1, 0}), 0);
  Ray ray;
  ray.direction = V3f(0, 1, 0);
  EXPECT_EQ(lit.lights->pdf_solid_angle(ray.origin, *lit.intersector->closest(ray)), 0);
}

TEST(Lights, RefuseWhatIsNotFinite) {
  Scene scene;
  scene.lights.push_back(point_at({0, 0, 0}, {std::numeric_limits<float>::infinity(), 0, 0}));
  const Intersector intersector(scene);
  EXPECT_THROW(Lights(scene, intersector), Error);
}

TEST(Lights, ZeroAreaEmittersAreLeftOut) {
  Scene scene;
  const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(1, 1, 1));
  add_mesh(scene, make_quad({0, 0, 0}, {1, 0, 0}, {2, 0, 0}, lamp));
  const Lit lit(std::move(scene));
  EXPECT_TRUE(lit.lights->empty());
}

}  // namespace
}  // namespace ivory
