// Paths through surfaces of part coverage: what they see of each, and how little of that is left to chance.
#include "tracer/render/crossings.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/lit_scene.h"
#include "tracer/core/sampling.h"
#include "tracer/render/final_gather.h"

namespace ivory {
namespace {

int add_blend(Scene& scene, float alpha, const Rgb& albedo, const Rgb& emission = Rgb(0, 0, 0)) {
  const int material = add_lambert(scene, albedo, emission, true);
  scene.materials[std::size_t(material)].alpha_mode = AlphaMode::blend;
  scene.materials[std::size_t(material)].alpha = alpha;
  return material;
}

Accumulator seen_by(const LitScene& lit, const Ray& eye, const PathParams& params, int count,
                    std::uint64_t stream = 0) {
  return collect(
      count,
      [&](RandomStream& random) {
        Ray ray = eye;
        ray.coverage_seed = random.next_u32();
        return trace_path(lit, ray, params, random);
      },
      stream);
}

// Sheets that shine before a wall that does: with a_i their coverage and E_i their emission the eye sees
// sum a_i E_i prod (1 - a_j), without any noise.
TEST(Crossings, EmissionThroughSheetsHasNoNoise) {
  Scene scene;
  double truth = 0;
  double passes = 1;
  for (int i = 0; i < 5; ++i) {
    const float alpha = 0.1F + 0.15F * float(i);
    const auto shines = float(1 + 3 * i);
    add_mesh(scene, make_quad({-1, -1, -float(i)}, {2, 0, 0}, {0, 2, 0},
                              add_blend(scene, alpha, Rgb(0, 0, 0), Rgb(1, 1, 1) * shines)));
    truth += passes * double(alpha) * double(shines);
    passes *= 1 - double(alpha);
  }
  add_mesh(scene, make_quad({-9, -9, -6}, {18, 0, 0}, {0, 18, 0}, add_lambert(scene, Rgb(0, 0, 0), Rgb(50, 50, 50))));
  truth += passes * 50;
  const LitScene lit = make_lit_scene(std::move(scene));
  const Accumulator seen = seen_by(lit, ray_to({0.1F, 0.2F, 3}, {0.1F, 0.3F, 0}), {}, 100);
  EXPECT_NEAR(seen.mean(), truth, 1e-5 * truth);  // float sums
  EXPECT_LT(seen.variance(), 1e-10 * truth * truth);
}

// The same with more sheets than are told apart: light is the same in the mean.
TEST(Crossings, ManySheetsKeepTheMean) {
  Scene scene;
  double truth = 0;
  double passes = 1;
  for (int i = 0; i < 14; ++i) {
    add_mesh(scene, make_quad({-1, -1, -0.1F * float(i)}, {2, 0, 0}, {0, 2, 0},
                              add_blend(scene, 0.15F, Rgb(0, 0, 0), Rgb(1, 1, 1) * float(i))));
    truth += passes * double(0.15F) * i;
    passes *= 1 - double(0.15F);
  }
  scene.environment = uniform_environment({4, 4, 4});
  truth += passes * 4;
  const LitScene lit = make_lit_scene(std::move(scene));
  const Accumulator seen = seen_by(lit, ray_to({0.1F, 0.2F, 3}, {0.1F, 0.3F, 0}), {}, 50'000);
  EXPECT_LT(std::abs(z_score(seen, truth)), z_limit);
}

// Matt sheets under a sun that shines through them, as final gather and the path tracer see them: sheet i has the
// weight w_i = a_i prod (1 - a_j) and the sun's light by the share prod (1 - a_j) of those before it. Nothing is left
// to chance but sheets of less than a thirty-second, here the fifth.
TEST(Crossings, FinalGatherLightsEachSheet) {
  constexpr float albedo = 0.5F;
  constexpr float sun_lux = 100;
  Scene scene;
  double truth = 0;
  double passes = 1;
  for (const float alpha : {0.5F, 0.4F, 0.6F, 0.5F, 0.3F}) {
    const auto place = -float(scene.meshes.size());
    add_mesh(scene,
             make_quad({-20, -20, place}, {40, 0, 0}, {0, 40, 0}, add_blend(scene, alpha, Rgb(1, 1, 1) * albedo)));
    truth += passes * double(alpha) * double(albedo) / double(pi) * double(sun_lux) * passes;
    passes *= 1 - double(alpha);
  }
  scene.lights.push_back(DirectionalLight{V3f(0, 0, -1), Rgb(1, 1, 1) * sun_lux});
  const LitScene lit = make_lit_scene(std::move(scene));
  const IndirectLight none([](const Surface&) { return Rgb(0, 0, 0); });
  const Accumulator seen = collect(4000, [&](RandomStream& random) {
    Ray ray = ray_to({0.1F, 0.2F, 3}, {0.1F, 0.3F, 0});
    ray.coverage_seed = random.next_u32();
    return trace_gather(lit, none, ray, {}, random);
  });
  EXPECT_LT(std::abs(z_score(seen, truth)), z_limit);
  EXPECT_LT(seen.variance(), 4e-6 * truth * truth);  // 2e-6 by that one
}

// A lamp behind cards of part coverage in a room, some of them shining themselves.
Scene cards_before_a_lamp() {
  Scene scene;
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), add_lambert(scene, Rgb(0.7F, 0.7F, 0.7F))));
  const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(80, 80, 80), true);
  add_mesh(scene, make_quad({-0.1F, -0.1F, -0.5F}, {0.2F, 0, 0}, {0, 0.2F, 0}, lamp));
  const int card = add_blend(scene, 0.4F, Rgb(0.8F, 0.8F, 0.8F));
  const int shining = add_blend(scene, 0.3F, Rgb(0.5F, 0.5F, 0.5F), Rgb(3, 3, 3));
  add_mesh(scene, make_quad({-0.3F, -0.3F, -0.4F}, {0.6F, 0, 0}, {0, 0.6F, 0}, card));
  add_mesh(scene, make_quad({-0.4F, -0.2F, -0.2F}, {0.6F, 0, 0.1F}, {0, 0.5F, 0}, shining));
  add_mesh(scene, make_quad({-0.3F, 0.3F, -0.6F}, {0.6F, 0, 0}, {0, 0.1F, 0.4F}, card));
  return scene;
}

// Against an estimator of its own kind: one surface met at random on each ray, all light by running into it. The eye
// looks through the cards at the lamp, past it, and at the floor.
Rgb trace_by_chance(const LitScene& lit, Ray ray, RandomStream& random) {
  Rgb radiance(0, 0, 0);
  Rgb throughput(1, 1, 1);
  for (int bounce = 0; bounce < 60; ++bounce) {
    ray.coverage_seed = random.next_u32();
    const std::optional<Hit> hit = lit.intersector.closest(ray);
    if (!hit) return radiance;
    const Surface surface = make_surface(*lit.scene, ray, *hit);
    radiance += throughput * surface.emission;
    const auto s = sample(make_bsdf(surface), -ray.direction, random.next(), random.next2());
    if (!s) return radiance;
    throughput *= s->throughput;
    if (is_black(throughput)) return radiance;
    ray = spawn_ray(surface, s->wi);
  }
  return radiance;
}

TEST(Crossings, LightIsThatOfSurfacesMetByChance) {
  const LitScene lit = make_lit_scene(cards_before_a_lamp());
  for (const V3f& target : {V3f(0, 0, -0.5F), V3f(0.25F, 0.1F, -0.4F), V3f(0.2F, -1, 0.1F), V3f(0, 0.35F, -0.4F)}) {
    const Ray ray = ray_to({0.05F, 0.1F, 0.9F}, target);
    const Accumulator by_chance = collect(
        60'000, [&](RandomStream& random) { return trace_by_chance(lit, ray, random); }, 7);
    double variance = 0;
    for (const DirectStrategy strategy : {DirectStrategy::mis, DirectStrategy::light, DirectStrategy::bsdf}) {
      PathParams params;
      params.strategy = strategy;
      const Accumulator seen = seen_by(lit, ray, params, 30'000, std::uint64_t(strategy));
      EXPECT_LT(std::abs(z_score(seen, by_chance)), z_limit) << target << " " << int(strategy);
      if (strategy == DirectStrategy::mis) variance = seen.variance();
    }
    EXPECT_LT(variance, by_chance.variance());
  }
}

// Only the last surface that light scatters at may be cut: with one scattering, what the eye sees is direct light.
TEST(Crossings, MaxBouncesAndIndirectAddUp) {
  const LitScene lit = make_lit_scene(cards_before_a_lamp());
  const Ray ray = ray_to({0.05F, 0.1F, 0.9F}, {0.25F, 0.1F, -0.4F});
  PathParams direct;
  direct.max_bounces = 1;
  PathParams indirect;
  indirect.indirect_only = true;
  const Accumulator sum = collect(30'000, [&](RandomStream& random) {
    return trace_path(lit, ray, direct, random) + trace_path(lit, ray, indirect, random);
  });
  EXPECT_LT(std::abs(z_score(sum, seen_by(lit, ray, {}, 30'000, 1))), z_limit);
}

}  // namespace
}  // namespace ivory
