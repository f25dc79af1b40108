// Small lights that stand for large ones, against the light of these.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/lights_check.h"
#include "tools/view/world/extended_lights.h"
#include "tracer/lights/environment.h"

namespace ivory {
namespace {

// E at p for normal n of lights without shadows, as shaders/renderer/punctual_lights.glsl has it.
Rgb irradiance(const std::vector<RuntimeLight>& lights, const V3f& p, const V3f& n) {
  Rgb e(0, 0, 0);
  for (const RuntimeLight& light : lights) {
    if (light.kind == LightKind::directional) {
      e += light.intensity * std::max(0.0F, -light.direction.dot(n));
      continue;
    }
    const V3f d = light.position_m - p;
    const float r2 = d.dot(d);
    const V3f w = d / std::sqrt(r2);
    e +=
        light.intensity * std::max(0.0F, w.dot(n)) * std::max(0.0F, -w.dot(light.direction)) / (r2 + light.extent / pi);
  }
  return e;
}

Rgb mean_irradiance(const ExtendedLights& lights, int samples, const V3f& p, const V3f& n) {
  Rgb sum(0, 0, 0);
  for (int i = 0; i < samples; ++i) sum += irradiance(small_lights(lights, i, std::vector<Placement>(2)), p, n);
  return sum / float(samples);
}

Rgb light_of(const std::vector<RuntimeLight>& lights) {
  Rgb sum(0, 0, 0);
  for (const RuntimeLight& light : lights) sum += light.intensity;
  return sum;
}

TEST(ExtendedLights, SamplesOfALampAddUpToIt) {
  const LitScene lit = in_black_box(lamp_scene(false));
  std::vector<ExtendedPoint> points = surface_points(*lit.scene, lit.lights, ExtendedKind::surfaces, 0);
  EXPECT_TRUE(surface_points(*lit.scene, lit.lights, ExtendedKind::spheres, 0).empty());
  const ExtendedLights lamp = make_extended_lights(ExtendedKind::surfaces, std::move(points), 4);
  ASSERT_EQ(int(lamp.ends.size()), group_count(ExtendedKind::surfaces));
  // 3 m2 of 10 nits, whichever points are chosen, in halves of halves of the lamp.
  for (const int i : {0, 1, 17}) {
    const std::vector<RuntimeLight> lights = small_lights(lamp, i, std::vector<Placement>(1));
    EXPECT_NEAR(light_of(lights).x, 30, 0.01F);
    for (const RuntimeLight& light : lights) {
      EXPECT_GT(light.intensity.x, 30.0F / 20);
      EXPECT_LT(light.intensity.x, 30.0F / 7);
      EXPECT_EQ(light.direction, V3f(0, -1, 0));
    }
  }
  // A metre and more away, of a lamp of 1 by 3 metres: one sample, whose pieces' areas dim what is near (8 % here), and
  // sixteen, where a third of that is left.
  for (const V3f& p : {V3f(0.5F, 0, 1.5F), V3f(-1, 0.3F, 0.2F), V3f(2, 1, 3)}) {
    const Accumulator truth = irradiance_samples(lit.lights, p, V3f(0, 1, 0), 400000);
    EXPECT_NEAR(double(mean_irradiance(lamp, 1, p, V3f(0, 1, 0)).x), truth.mean(), 0.1 * truth.mean()) << p;
    EXPECT_NEAR(double(mean_irradiance(lamp, 16, p, V3f(0, 1, 0)).x), truth.mean(), 0.04 * truth.mean()) << p;
  }
  // Right at the lamp E is bounded by what a surface of that radiance can give, from the first sample on.
  EXPECT_LE(irradiance(small_lights(lamp, 0, std::vector<Placement>(1)), V3f(0.5F, 1.999F, 1.5F), V3f(0, 1, 0)).x,
            1.5F * pi * 10);
}

// The two sides of a panel are lights of their own, however near: no point of one has light of the other.
TEST(ExtendedLights, SidesOfAPanelKeepApart) {
  const LitScene lit = in_black_box(lamp_scene(true));
  const ExtendedLights lamp = make_extended_lights(
      ExtendedKind::surfaces, surface_points(*lit.scene, lit.lights, ExtendedKind::surfaces, 0), 4);
  for (const V3f& p : {V3f(0.5F, 0, 1.5F), V3f(0.5F, 4, 1.5F)}) {
    const V3f n = p.y < 2 ? V3f(0, 1, 0) : V3f(0, -1, 0);
    const Accumulator truth = irradiance_samples(lit.lights, p, n, 400000);
    EXPECT_NEAR(double(mean_irradiance(lamp, 16, p, n).x), truth.mean(), 0.03 * truth.mean()) << p;
  }
}

// A sky with a small bright sun, against a sum over all texels.
TEST(ExtendedLights, SamplesOfASkyAddUpToIt) {
  EnvironmentMap map;
  map.width = 64;
  map.height = 32;
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column) {
      const float up = row < 16 ? 1.0F : 0.3F;
      map.radiance.push_back(row == 6 && column == 20 ? Rgb(3000, 2500, 2000) : Rgb(1, 1.2F, 1.5F) * up);
    }
  }
  const ExtendedLights sky = make_extended_lights(ExtendedKind::environment, environment_points(map), 1);
  ASSERT_EQ(int(sky.ends.size()), group_count(ExtendedKind::environment));
  const EnvironmentLight light = make_environment_light(map);
  const auto all = double(light_of(small_lights(sky, 0, {})).y);  // lux, from all around
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 20; ++i) {
    const V3f n = V3f(normal(random), normal(random), normal(random)).normalized();
    RandomStream stream = test_stream(std::uint64_t(i));
    Accumulator truth;
    for (int k = 0; k < 200000; ++k) {
      const auto s = sample(light, stream);
      truth.add(double(s->irradiance_weight.y * std::max(0.0F, s->w.dot(n))));
    }
    // Of all light that falls in, not of E: where the sun grazes, little of it counts and much of its error.
    EXPECT_NEAR(double(mean_irradiance(sky, 16, V3f(0, 0, 0), n).y), truth.mean(),
                0.01 * all + 4 * truth.standard_error())
        << n;
  }
}

}  // namespace
}  // namespace ivory
