// Every kind of light against closed forms: its power, the photons it emits, the irradiance it
// gives to a point, and the densities it claims.
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
  const LitScene lit = in_black_box(std::move(scene));
  expect_power_and_photons_agree(lit.lights, Rgb(2, 1, 0.5F) * (4 * pi), "point");
  const auto e = irradiance_samples(lit.lights, {0.1F, 0.2F, 2.3F}, {0, 0, -1}, 10);
  EXPECT_NEAR(e.mean(), 2.0 / 4.0, 1e-6);
}

// A hard edge: all of the intensity up to the angle, none beyond, and its flux 2 pi I (1 - cos), however narrow.
TEST(Lights, SpotsWithHardEdges) {
  for (const float angle : {1.5F, 0.5F, 0.03F, 0.003F}) {
    SpotLight spot;
    spot.position = V3f(0.3F, 0.2F, -0.1F);
    spot.direction = V3f(0, 0, 1);
    spot.intensity_cd = Rgb(7, 7, 7);
    spot.inner_angle_rad = spot.outer_angle_rad = angle;
    Scene scene;
    scene.lights.push_back(spot);
    const LitScene lit = in_black_box(std::move(scene));
    RandomStream random = test_stream();
    for (const float share : {0.0F, 0.5F, 0.999F, 1.001F, 1.5F}) {
      const float a = share * angle;
      const V3f p = spot.position + V3f(std::sin(a), 0, std::cos(a)) * 2;
      const auto sample = lit.lights.sample(p, random);
      EXPECT_EQ(sample.has_value(), share < 1) << angle << " " << share;
      if (sample) {
        EXPECT_NEAR(sample->irradiance_weight.x, 7.0F / 4, 1e-4F) << angle << " " << share;
      }
    }
    const double flux = 7 * 2 * double(pi) * 2 * std::pow(std::sin(0.5 * double(angle)), 2);
    EXPECT_NEAR(lit.lights.total_power_lm().x, flux, 1e-5 * flux) << angle;
  }
}

TEST(Lights, SpotLight) {
  struct Cone {
    float inner, outer;
  };
  for (const Cone cone : {Cone{0.2F, 0.7F}, Cone{0, pi / 2}, Cone{0.5F, 0.5F}, Cone{0, 0.02F}, Cone{0.03F, 0.03F}}) {
    SpotLight spot;
    spot.position = V3f(0, 0, 0);
    spot.direction = V3f(1, -2, 0.5F).normalized();
    spot.intensity_cd = Rgb(3, 3, 3);
    spot.inner_angle_rad = cone.inner;
    spot.outer_angle_rad = cone.outer;
    // Flux by quadrature of the specification's own formula.
    const double width = std::max(1e-9, std::cos(double(cone.inner)) - std::cos(double(cone.outer)));
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
    const LitScene lit = in_black_box(std::move(scene));
    const Rgb power = lit.lights.total_power_lm();
    // The quadrature has 2e5 steps over [-1, 1]: the narrowest cone covers 20 of them.
    EXPECT_NEAR(power.x, flux, (cone.outer < 0.1F ? 0.02F : 1e-4F) * flux);
    expect_power_and_photons_agree(lit.lights, power, "spot");

    // Photons spread as the intensity does: flux counted in rings of equal cosine.
    RandomStream random = test_stream();
    constexpr int rings = 20;
    constexpr int photons = 200000;
    std::vector<double> counts(rings, 0);
    std::vector<double> expected(rings, 0);
    const double lowest = std::cos(double(cone.outer));
    for (int i = 0; i < photons; ++i) {
      const double cosine = double(lit.lights.emit(random).direction.dot(spot.direction));
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
    // A float cosine near 1 is good to 6e-8, of a zone that may be only 2e-4 wide.
    EXPECT_NEAR(irradiance_samples(lit.lights, p, -spot.direction, 4).mean(), expected_e, 1e-3 * expected_e);
    const V3f outside =
        make_shading_frame(spot.direction).to_world(direction_at_cosine(std::cos(cone.outer + 0.01F), 0.3F));
    EXPECT_FALSE(lit.lights.sample(outside, random));
  }
}

TEST(Lights, DirectionalLight) {
  Scene scene;
  const V3f direction = V3f(1, -3, 2).normalized();
  scene.lights.push_back(DirectionalLight{direction, Rgb(5, 5, 5)});
  const LitScene lit = in_black_box(std::move(scene));
  const float radius = lit.intersector.radius_m();
  expect_power_and_photons_agree(lit.lights, Rgb(5, 5, 5) * (pi * radius * radius), "directional");
  const V3f n = V3f(0, 1, 0);
  EXPECT_NEAR(irradiance_samples(lit.lights, {0, 0, 0}, n, 4).mean(), 5.0 * double(-direction.dot(n)), 1e-5);
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
    const LitScene lit = in_black_box(std::move(scene));
    Accumulator photons;
    flux_per_area(lit.lights, p, n, 0.15F, photons);
    const Accumulator e = irradiance_samples(lit.lights, p, n, 400000);
    EXPECT_GT(e.mean(), 0);
    // 0.2 % for the variation of E over the disc.
    const double error = std::hypot(photons.standard_error(), e.standard_error());
    EXPECT_LT(std::abs(photons.mean() - e.mean()), z_limit * error + 2e-3 * e.mean()) << source.name;
  }
}

// q = p / 2 + 1 / 6, with power by the strongest channel.
TEST(Lights, ArePickedByPowerAndEvenly) {
  Scene scene;
  scene.lights.push_back(point_at({0, 0, 2}, {9, 9, 9}));
  scene.lights.push_back(point_at({0, 2, 0}, {1, 1, 1}));
  scene.lights.push_back(point_at({2, 0, 0}, {0, 0, 1e-3F}));  // a speck of blue must not be forgotten
  const LitScene lit = in_black_box(std::move(scene));
  RandomStream random = test_stream();
  Accumulator from_z;
  Accumulator blue;
  for (int i = 0; i < 1000000; ++i) {
    const auto s = lit.lights.sample({0, 0, 0}, random);
    from_z.add(s->w.z > 0.5F ? 1 : 0);
    blue.add(s->w.x > 0.5F ? double(s->irradiance_weight.z) : 0);
  }
  EXPECT_LT(std::abs(z_score(from_z, 0.5 * 9 / (10 + 1e-3) + 1.0 / 6)), z_limit);
  EXPECT_LT(std::abs(z_score(blue, 1e-3 / 4)), z_limit);
}

TEST(Lights, PhotonsCarryWhatTheirRangeSays) {
  Scene scene = lamp_scene(false);
  scene.lights.push_back(point_at({0, 0, 2}, {0, 0, 7}));
  scene.lights.push_back(DirectionalLight{V3f(0, -1, 0), Rgb(1, 0, 0)});
  scene.environment = uniform_environment({0.1F, 0.5F, 0.2F});
  const LitScene lit = in_black_box(std::move(scene));
  RandomStream random = test_stream();
  const Lights::PhotonPower range = lit.lights.photon_power();
  float least = std::numeric_limits<float>::infinity();
  float most = 0;
  for (int i = 0; i < 10000; ++i) {
    const float power = max_component(lit.lights.emit(random).power);
    least = std::min(least, power);
    most = std::max(most, power);
  }
  EXPECT_NEAR(least, range.weakest_lm, 1e-4F * least);
  EXPECT_NEAR(most, range.strongest_lm, 1e-4F * most);
  // No photon carries more than twice what picking by power gives it.
  EXPECT_LT(most, 2.0001F * (max_component(Rgb(10, 5, 1)) * pi * 3 + 4 * pi * 7 +
                             pi * std::pow(lit.intersector.radius_m(), 2.0F) * (1 + 0.5F * 4 * pi)));
}

TEST(Lights, DarkScenesHaveNone) {
  Scene scene;
  const int grey = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), grey));
  scene.lights.push_back(point_at({0, 0, 0}, {0, 0, 0}));
  scene.environment = uniform_environment({0, 0, 0});
  const LitScene lit = in_black_box(std::move(scene));
  RandomStream random = test_stream();
  EXPECT_TRUE(lit.lights.empty());
  EXPECT_FALSE(lit.lights.has_extended());
  EXPECT_FALSE(lit.lights.sample({0, 0, 0}, random));
  EXPECT_EQ(lit.lights.emit(random).power, Rgb(0, 0, 0));
  EXPECT_EQ(lit.lights.environment_pdf_solid_angle({0, 1, 0}), 0);
  Ray ray;
  ray.direction = V3f(0, 1, 0);
  EXPECT_EQ(lit.lights.pdf_solid_angle(ray.origin, *lit.intersector.closest(ray)), 0);
}

TEST(Lights, RefuseWhatIsNotFinite) {
  Scene scene;
  scene.lights.push_back(point_at({0, 0, 0}, {std::numeric_limits<float>::infinity(), 0, 0}));
  EXPECT_THROW(make_lit_scene(std::move(scene)), Error);
}

}  // namespace
}  // namespace ivory
