// The path tracer and its pictures against closed forms, against each other, and against themselves by other means.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/lit_scene.h"
#include "tracer/core/sampling.h"

namespace ivory {
namespace {

TEST(PathTracer, FurnaceIsTheGeometricSeries) {
  for (const float albedo : {0.0F, 0.5F, 0.9F}) {
    const LitScene lit = make_lit_scene(furnace(albedo, Rgb(2, 2, 2)));
    const Accumulator l = path_samples(lit, ray_to({0.1F, 0.2F, 0.3F}, {-1, 0.5F, 0.4F}), {}, 20000);
    EXPECT_LT(std::abs(z_score(l, 2.0 / (1 - double(albedo)))), z_limit) << albedo;
    PathParams indirect;
    indirect.indirect_only = true;
    const Accumulator i = path_samples(lit, ray_to({0.1F, 0.2F, 0.3F}, {-1, 0.5F, 0.4F}), indirect, 20000);
    const double rho = double(albedo);
    EXPECT_LT(std::abs(z_score(i, 2 * rho * rho / (1 - rho))), z_limit) << albedo;
  }
}

TEST(PathTracer, MaxBouncesCutsTheSeries) {
  const LitScene lit = make_lit_scene(furnace(0.5F, Rgb(1, 1, 1)));
  double truth = 0;
  for (int bounces = 0; bounces < 5; ++bounces) {
    truth += std::pow(0.5, bounces);
    PathParams params;
    params.max_bounces = bounces;
    const Accumulator l = path_samples(lit, ray_to({0, 0, 0}, {-1, 0.5F, 0.4F}), params, 20000);
    EXPECT_LT(std::abs(z_score(l, truth)), z_limit) << bounces;
  }
}

TEST(PathTracer, StrategiesAgree) {
  Scene scene = small_room();
  scene.lights.clear();  // sampling the BSDF alone finds no point light
  const LitScene lit = make_lit_scene(std::move(scene));
  // The floor, glossy; the wall; the ceiling near the lamp; the box.
  for (const V3f& target : {V3f(-0.2F, -0.99F, 0.3F), V3f(-1, 0, 0.2F), V3f(0.35F, 1, 0.1F), V3f(0.3F, -0.5F, 0.2F)}) {
    std::vector<Accumulator> results;
    for (const DirectStrategy strategy : {DirectStrategy::mis, DirectStrategy::light, DirectStrategy::bsdf}) {
      PathParams params;
      params.strategy = strategy;
      results.push_back(path_samples(lit, ray_to({0, 0.2F, 0.9F}, target), params, 100000, results.size()));
    }
    EXPECT_LT(std::abs(z_score(results[0], results[1])), z_limit);
    EXPECT_LT(std::abs(z_score(results[0], results[2])), z_limit);
    EXPECT_GT(results[0].mean(), 0);
  }
}

TEST(PathTracer, StrategiesAgreeUnderAnEnvironment) {
  Scene scene;
  const int grey = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
  Material metal;
  metal.roughness = 0.3F;
  scene.materials.push_back(metal);
  add_mesh(scene, make_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, grey));
  add_mesh(scene, make_quad({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, 1));
  EnvironmentMap map = uniform_environment({0.2F, 0.2F, 0.2F}, 16);
  for (int i = 0; i < 6; ++i) map.radiance[std::size_t(5 * 32 + 10 + i)] = Rgb(30, 30, 30);
  scene.environment = map;
  const LitScene lit = make_lit_scene(std::move(scene));
  for (const V3f& target : {V3f(0.2F, 0, 0.3F), V3f(0.1F, 0.4F, -1)}) {
    std::vector<Accumulator> results;
    for (const DirectStrategy strategy : {DirectStrategy::mis, DirectStrategy::light, DirectStrategy::bsdf}) {
      PathParams params;
      params.strategy = strategy;
      results.push_back(path_samples(lit, ray_to({0.5F, 1, 2}, target), params, 200000, results.size()));
    }
    EXPECT_LT(std::abs(z_score(results[0], results[1])), z_limit);
    EXPECT_LT(std::abs(z_score(results[0], results[2])), z_limit);
  }
}

// Direct light is what max_bounces 1 leaves, less what shines by itself; the rest is indirect.
TEST(PathTracer, DirectAndIndirectAddUp) {
  const LitScene lit = make_lit_scene(small_room());
  for (const V3f& target : {V3f(-0.2F, -0.99F, 0.3F), V3f(-1, 0, 0.2F), V3f(0, 0.98F, 0)}) {
    const Ray ray = ray_to({0, 0.2F, 0.9F}, target);
    PathParams direct;
    direct.max_bounces = 1;
    PathParams indirect;
    indirect.indirect_only = true;
    const Accumulator sum = collect(100000, [&](RandomStream& random) {
      return trace_path(lit, ray, direct, random) + trace_path(lit, ray, indirect, random);
    });
    EXPECT_LT(std::abs(z_score(sum, path_samples(lit, ray, {}, 100000, 1))), z_limit);
  }
}

// A plate of coverage alpha before a glowing wall: the eye sees alpha of its own light and 1 - alpha
// of the wall; a point behind it gets 1 - alpha of a light before it.
TEST(PathTracer, BlendCoversByAlpha) {
  Scene scene;
  const int plate = add_lambert(scene, Rgb(0, 0, 0), Rgb(5, 5, 5), true);
  scene.materials[std::size_t(plate)].alpha_mode = AlphaMode::blend;
  scene.materials[std::size_t(plate)].alpha = 0.3F;
  const int wall = add_lambert(scene, Rgb(0, 0, 0), Rgb(1, 1, 1));
  add_mesh(scene, make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, plate));
  add_mesh(scene, make_quad({-5, -5, -1}, {10, 0, 0}, {0, 10, 0}, wall));
  const LitScene lit = make_lit_scene(std::move(scene));
  const Accumulator seen = collect(100000, [&](RandomStream& random) {
    Ray ray = ray_to({0.1F, 0.2F, 3}, {0.1F, 0.3F, 0});
    ray.coverage_seed = random.next_u32();
    return trace_path(lit, ray, {}, random);
  });
  EXPECT_LT(std::abs(z_score(seen, 0.3 * 5 + 0.7 * 1)), z_limit);
}

TEST(PathTracer, BlendDimsShadowRaysAndEmitters) {
  Scene scene;
  const int glass = add_lambert(scene, Rgb(0, 0, 0));
  scene.materials[std::size_t(glass)].alpha_mode = AlphaMode::blend;
  scene.materials[std::size_t(glass)].alpha = 0.4F;
  const int grey = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
  const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(8, 8, 8));
  scene.materials[std::size_t(lamp)].alpha_mode = AlphaMode::blend;
  scene.materials[std::size_t(lamp)].alpha = 0.5F;
  add_mesh(scene, make_quad({-5, 1, -5}, {10, 0, 0}, {0, 0, 10}, glass));
  add_mesh(scene, make_quad({-5, 0, -5}, {0, 0, 10}, {10, 0, 0}, grey));  // floor, looks up
  add_mesh(scene, make_quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, lamp));    // looks down
  const LitScene lit = make_lit_scene(std::move(scene));
  const Ray ray = ray_to({3, 0.5F, 0}, {0.3F, 0, 0.1F});
  std::vector<Accumulator> results;
  for (const DirectStrategy strategy : {DirectStrategy::mis, DirectStrategy::light, DirectStrategy::bsdf}) {
    PathParams params;
    params.max_bounces = 1;
    params.strategy = strategy;
    results.push_back(path_samples(lit, ray, params, 200000, results.size()));
  }
  EXPECT_LT(std::abs(z_score(results[0], results[1])), z_limit);
  EXPECT_LT(std::abs(z_score(results[0], results[2])), z_limit);
}

TEST(PathTracer, DarkSceneIsBlack) {
  const LitScene lit = make_lit_scene(furnace(0.5F, Rgb(0, 0, 0)));
  EXPECT_EQ(path_samples(lit, ray_to({0, 0, 0}, {1, 0, 0}), {}, 10).mean(), 0);
}

TEST(Render, GivesTheSameBytesOnAnyNumberOfThreads) {
  const LitScene lit = make_lit_scene(small_room());
  RenderParams one;
  one.samples = 4;
  one.threads = 1;
  RenderParams two = one;
  two.threads = 2;
  const View view = test_view(40, 30);
  EXPECT_EQ(render_path(lit, view, one, {}).pixels, render_path(lit, view, two, {}).pixels);
}

TEST(Render, SeedsChangeNoiseNotTheMean) {
  const LitScene lit = make_lit_scene(small_room());
  const View view = test_view(32, 24);
  RenderParams params;
  params.samples = 16;
  Accumulator difference;
  const Film a = render_path(lit, view, params, {});
  params.seed = 2;
  const Film b = render_path(lit, view, params, {});
  for (std::size_t i = 0; i < a.pixels.size(); ++i) difference.add(double(a.pixels[i].y - b.pixels[i].y));
  EXPECT_GT(difference.variance(), 0);
  EXPECT_LT(std::abs(difference.mean()), z_limit * difference.standard_error());
}

// Pictures' means over seeds against independent random numbers all the way.
TEST(Render, EvenSamplesAreUnbiased) {
  const LitScene lit = make_lit_scene(small_room());
  const View view = test_view(8, 6);
  Accumulator even;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    RenderParams params;
    params.samples = 16;
    params.seed = seed;
    const Film film = render_path(lit, view, params, {});
    double mean = 0;
    for (const Rgb& pixel : film.pixels) mean += double(pixel.y) / double(film.pixels.size());
    even.add(mean);
  }
  const Accumulator independent = collect(200000, [&](RandomStream& random) {
    Ray ray = make_ray(view, random.next2() * V2f(8, 6));
    ray.coverage_seed = random.next_u32();
    return trace_path(lit, ray, {}, random);
  });
  EXPECT_LT(std::abs(z_score(even, independent)), z_limit);
}

TEST(Render, ReportsProgressToTheEnd) {
  const LitScene lit = make_lit_scene(furnace(0.5F, Rgb(1, 1, 1)));
  RenderParams params;
  params.samples = 1;
  params.threads = 1;
  double last = 0;
  params.progress = [&](double fraction) { last = fraction; };
  render_path(lit, test_view(33, 17), params, {});
  EXPECT_EQ(last, 1);
}

// What is left of diffuse light on a surface whose shading normal leans away from ng: of the cosine around ns the part
// below ng is lost, and above it light fades as Chiang, Li & Burley (2019) have it. By 1000 x 1000 directions, which
// the fade's kink costs less than 1e-5.
double left_by_leaning(const V3f& ng, const V3f& ns) {
  constexpr int side = 1000;
  const V3f x = ns.cross(std::abs(ns.x) < 0.5F ? V3f(1, 0, 0) : V3f(0, 1, 0)).normalized();
  const V3f y = ns.cross(x);
  double sum = 0;
  for (int i = 0; i < side; ++i) {
    const float cosine = std::sqrt((float(i) + 0.5F) / side);
    const float sine = std::sqrt(1 - cosine * cosine);
    for (int k = 0; k < side; ++k) {
      const float phi = 2 * pi * (float(k) + 0.5F) / side;
      const V3f w = x * (sine * std::cos(phi)) + y * (sine * std::sin(phi)) + ns * cosine;
      const double g = std::clamp(double(w.dot(ng)) / (double(cosine) * double(ns.dot(ng))), 0.0, 1.0);
      sum += g + g * g - g * g * g;
    }
  }
  return sum / (double(side) * side);
}

// Interpolated normals lean away from the eye near silhouettes; a white surface in white surroundings must
// not show that as black.
TEST(PathTracer, LeaningNormalsStayLit) {
  Scene scene;
  const int white = add_lambert(scene, Rgb(1, 1, 1));
  Mesh mesh = make_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, white);
  mesh.normals.assign(4, V3f(-0.6F, 0.8F, 0));
  add_mesh(scene, mesh);
  scene.environment = uniform_environment({1, 1, 1});
  const LitScene lit = make_lit_scene(std::move(scene));
  for (const float height : {0.01F, 0.3F, 0.76F, 3.0F}) {
    const Ray ray = ray_to({1, height, 0}, {0, 0, 0});
    const auto hit = lit.intersector.closest(ray);
    ASSERT_TRUE(hit);
    const Surface surface = make_surface(*lit.scene, ray, *hit);
    EXPECT_GT(surface.ns.dot(-ray.direction), 0);
    EXPECT_GT(surface.ns.dot(surface.ng), 0);
    EXPECT_NEAR(surface.ns.length(), 1, 1e-6F);
    const double left = left_by_leaning(surface.ng, surface.ns);
    EXPECT_LE(left, 0.5 * (1 + double(surface.ns.dot(surface.ng))) + 1e-5);  // what is above the facet
    const Accumulator l = path_samples(lit, ray, {}, 20000);
    EXPECT_LT(std::abs(z_score(l, left)), z_limit) << height;
  }
}

}  // namespace
}  // namespace ivory
