// The renderers against closed forms, against each other, and against themselves by other means.
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/statistics.h"
#include "tools/stability/scene_builder.h"
#include "tracer/final_gather.h"
#include "tracer/path_tracer.h"
#include "tracer/probe.h"
#include "tracer/sampling.h"

namespace ivory {
namespace {

struct Lit {
  Scene scene;
  Intersector intersector;
  Lights lights;

  explicit Lit(Scene s) : scene(std::move(s)), intersector(scene), lights(scene, intersector) {}
};

Ray ray_to(const V3f& origin, const V3f& target) {
  Ray ray;
  ray.origin = origin;
  ray.direction = (target - origin).normalized();
  return ray;
}

using Estimate = std::function<Rgb(RandomStream&)>;

// Green channel of `count` independent estimates.
Accumulator collect(int count, const Estimate& estimate, std::uint64_t stream = 0) {
  RandomStream random(11, StreamPurpose::test, stream);
  Accumulator samples;
  for (int i = 0; i < count; ++i) samples.add(double(estimate(random).y));
  return samples;
}

Accumulator path_samples(const Lit& lit, const Ray& ray, const PathParams& params, int count,
                         std::uint64_t stream = 0) {
  return collect(
      count, [&](RandomStream& random) { return trace_path(lit.intersector, lit.lights, ray, params, random); },
      stream);
}

Scene furnace(float albedo, const Rgb& emission) {
  Scene scene;
  const int wall = add_lambert(scene, Rgb(albedo, albedo, albedo), emission);
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), wall));
  return scene;
}

TEST(PathTracer, FurnaceIsTheGeometricSeries) {
  for (const float albedo : {0.0F, 0.5F, 0.9F}) {
    const Lit lit(furnace(albedo, Rgb(2, 2, 2)));
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
  const Lit lit(furnace(0.5F, Rgb(1, 1, 1)));
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
  const Lit lit(std::move(scene));
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
  const Lit lit(std::move(scene));
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
  const Lit lit(small_room());
  for (const V3f& target : {V3f(-0.2F, -0.99F, 0.3F), V3f(-1, 0, 0.2F), V3f(0, 0.98F, 0)}) {
    const Ray ray = ray_to({0, 0.2F, 0.9F}, target);
    PathParams direct;
    direct.max_bounces = 1;
    PathParams indirect;
    indirect.indirect_only = true;
    const Accumulator sum = collect(100000, [&](RandomStream& random) {
      return trace_path(lit.intersector, lit.lights, ray, direct, random) +
             trace_path(lit.intersector, lit.lights, ray, indirect, random);
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
  const Lit lit(std::move(scene));
  const Accumulator seen = collect(100000, [&](RandomStream& random) {
    Ray ray = ray_to({0.1F, 0.2F, 3}, {0.1F, 0.3F, 0});
    ray.coverage_seed = random.next_u32();
    return trace_path(lit.intersector, lit.lights, ray, {}, random);
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
  const Lit lit(std::move(scene));
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
  const Lit lit(furnace(0.5F, Rgb(0, 0, 0)));
  EXPECT_EQ(path_samples(lit, ray_to({0, 0, 0}, {1, 0, 0}), {}, 10).mean(), 0);
}

View test_view(int width, int height) {
  Camera camera;
  camera.to_world[3][1] = 0.2F;
  camera.to_world[3][2] = 0.9F;
  camera.yfov_rad = 1.2F;
  return make_view("test", camera, width, height);
}

TEST(Render, GivesTheSameBytesOnAnyNumberOfThreads) {
  const Lit lit(small_room());
  RenderParams one;
  one.samples = 4;
  one.threads = 1;
  RenderParams two = one;
  two.threads = 2;
  const View view = test_view(40, 30);
  EXPECT_EQ(render_path(lit.intersector, lit.lights, view, one, {}).pixels,
            render_path(lit.intersector, lit.lights, view, two, {}).pixels);
}

TEST(Render, SeedsChangeNoiseNotTheMean) {
  const Lit lit(small_room());
  const View view = test_view(32, 24);
  RenderParams params;
  params.samples = 16;
  Accumulator difference;
  const Film a = render_path(lit.intersector, lit.lights, view, params, {});
  params.seed = 2;
  const Film b = render_path(lit.intersector, lit.lights, view, params, {});
  for (std::size_t i = 0; i < a.pixels.size(); ++i) difference.add(double(a.pixels[i].y - b.pixels[i].y));
  EXPECT_GT(difference.variance(), 0);
  EXPECT_LT(std::abs(difference.mean()), z_limit * difference.standard_error());
}

// Pictures' means over seeds against independent random numbers all the way.
TEST(Render, EvenSamplesAreUnbiased) {
  const Lit lit(small_room());
  const View view = test_view(8, 6);
  Accumulator even;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    RenderParams params;
    params.samples = 16;
    params.seed = seed;
    const Film film = render_path(lit.intersector, lit.lights, view, params, {});
    double mean = 0;
    for (const Rgb& pixel : film.pixels) mean += double(pixel.y) / double(film.pixels.size());
    even.add(mean);
  }
  const Accumulator independent = collect(200000, [&](RandomStream& random) {
    Ray ray = make_ray(view, random.next2() * V2f(8, 6));
    ray.coverage_seed = random.next_u32();
    return trace_path(lit.intersector, lit.lights, ray, {}, random);
  });
  EXPECT_LT(std::abs(z_score(even, independent)), z_limit);
}

TEST(Render, ReportsProgressToTheEnd) {
  const Lit lit(furnace(0.5F, Rgb(1, 1, 1)));
  RenderParams params;
  params.samples = 1;
  params.threads = 1;
  double last = 0;
  params.progress = [&](double fraction) { last = fraction; };
  render_path(lit.intersector, lit.lights, test_view(33, 17), params, {});
  EXPECT_EQ(last, 1);
}

// Grids made by hand, so that these tests judge the renderer alone: uniform light of radiance L gives
// E = pi L for every normal.
IrradianceGrid uniform_grid(float radiance) {
  IrradianceGrid grid;
  grid.frame.size = V3i(2, 2, 2);
  grid.frame.origin_m = V3f(-1, -1, -1);
  grid.frame.spacing_m = V3f(2, 2, 2);
  grid.basis = Basis::ambient_cube;
  // Moments of max(0, w_i): pi L each.
  grid.moments.assign(8 * 18, pi * radiance);
  grid.visible_fraction.assign(8, 1.0F);
  grid.variance.assign(8, Rgb(0, 0, 0));
  return grid;
}

TEST(FinalGather, FurnaceEqualsThePathTracer) {
  // Indirect light in the furnace arrives evenly: L_i = L_e rho/(1-rho).
  const float rho = 0.5F;
  const Lit lit(furnace(rho, Rgb(2, 2, 2)));
  const IrradianceGrid grid = uniform_grid(2 * rho / (1 - rho));
  for (const Guard guard : {Guard::rays, Guard::off}) {
    for (const int rays : {0, 1, 7}) {
      for (const bool indirect_only : {false, true}) {
        GatherParams params;
        params.gather_rays = rays;
        params.indirect_only = indirect_only;
        GridLight light;
        light.grid = &grid;
        light.guard = guard;
        const Ray ray = ray_to({0.1F, 0.2F, 0.3F}, {-1, 0.5F, 0.4F});
        const Accumulator l = collect(20000, [&](RandomStream& random) {
          return trace_gather(lit.intersector, lit.lights, light, ray, params, random);
        });
        // Full light L_e/(1-rho) = 4; indirect alone rho^2/(1-rho) L_e = 1.
        EXPECT_LT(std::abs(z_score(l, indirect_only ? 1.0 : 4.0)), z_limit) << rays << indirect_only;
      }
    }
  }
}

// White uniform surroundings and a closed box: whatever the walls reflect, a grid of that uniform light
// makes direct, gather and path agree, glossy walls included.
TEST(FinalGather, GlossyFurnaceEqualsThePathTracer) {
  Scene scene;
  Material glossy;
  glossy.base_color = Rgb(0.5F, 0.5F, 0.5F);
  glossy.metallic = 0.5F;
  glossy.roughness = 0.5F;
  scene.materials.push_back(glossy);
  add_mesh(scene, make_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0));
  scene.environment = uniform_environment({1, 1, 1});
  const Lit lit(std::move(scene));
  // One plane in a uniform environment: nothing is indirect.
  const IrradianceGrid grid = uniform_grid(0);
  const Ray ray = ray_to({1, 1, 0}, {0.1F, 0, 0.1F});
  const Accumulator path = path_samples(lit, ray, {}, 100000);
  for (const int rays : {0, 4}) {
    GatherParams params;
    params.gather_rays = rays;
    GridLight light;
    light.grid = &grid;
    const Accumulator l = collect(
        100000,
        [&](RandomStream& random) { return trace_gather(lit.intersector, lit.lights, light, ray, params, random); }, 1);
    EXPECT_LT(std::abs(z_score(l, path)), z_limit);
  }
}

TEST(FinalGather, EvenSamplesAreUnbiased) {
  const Lit lit(small_room());
  const IrradianceGrid grid = uniform_grid(0.5F);
  GridLight light;
  light.grid = &grid;
  light.guard = Guard::off;
  GatherParams params;
  params.gather_rays = 3;
  const View view = test_view(8, 6);
  Accumulator even;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    RenderParams render;
    render.samples = 8;
    render.seed = seed;
    const Film film =
        render_gather(lit.intersector, lit.lights, indirect_light(lit.intersector, light), view, render, params);
    double mean = 0;
    for (const Rgb& pixel : film.pixels) mean += double(pixel.y) / double(film.pixels.size());
    even.add(mean);
  }
  const Accumulator independent = collect(100000, [&](RandomStream& random) {
    Ray ray = make_ray(view, random.next2() * V2f(8, 6));
    ray.coverage_seed = random.next_u32();
    return trace_gather(lit.intersector, lit.lights, light, ray, params, random);
  });
  EXPECT_LT(std::abs(z_score(even, independent)), z_limit);
}

// With a black grid, direct shows direct light and gather adds exactly one bounce.
TEST(FinalGather, GatherAddsOneBounceToDirect) {
  Scene scene = small_room();
  scene.materials[2] = scene.materials[0];  // all diffuse: specular chains add bounces of their own
  const Lit lit(std::move(scene));
  const IrradianceGrid grid = uniform_grid(0);
  GridLight light;
  light.grid = &grid;
  for (const V3f& target : {V3f(-0.2F, -0.99F, 0.3F), V3f(-1, 0, 0.2F)}) {
    const Ray ray = ray_to({0, 0.2F, 0.9F}, target);
    for (const int rays : {0, 3}) {
      GatherParams params;
      params.gather_rays = rays;
      PathParams path;
      path.max_bounces = rays > 0 ? 2 : 1;
      const Accumulator l = collect(100000, [&](RandomStream& random) {
        return trace_gather(lit.intersector, lit.lights, light, ray, params, random);
      });
      EXPECT_LT(std::abs(z_score(l, path_samples(lit, ray, path, 100000, 1))), z_limit) << rays;
    }
  }
}

// A smooth floor, of metal or black plastic, shows a wall that the grid lights evenly: Fresnel's share of it.
TEST(FinalGather, ReflectionsShowTheGridLitRoom) {
  for (const bool metal : {true, false}) {
    Scene scene;
    Material smooth;
    smooth.roughness = 0;
    smooth.metallic = metal ? 1.0F : 0.0F;
    if (!metal) smooth.base_color = Rgb(0, 0, 0);
    scene.materials.push_back(smooth);
    const int grey = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
    add_mesh(scene, make_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0));      // floor, looks up
    add_mesh(scene, make_quad({-2, -2, -1}, {4, 0, 0}, {0, 4, 0}, grey));  // wall behind, looks to +z
    const Lit lit(std::move(scene));
    const IrradianceGrid grid = uniform_grid(2);
    GridLight light;
    light.grid = &grid;
    light.guard = Guard::off;
    const Ray ray = ray_to({0, 0.5F, 0.5F}, {0, 0, -0.2F});
    const Accumulator l = collect(100000, [&](RandomStream& random) {
      return trace_gather(lit.intersector, lit.lights, light, ray, {}, random);
    });
    const double f0 = metal ? 1 : 0.04;
    const double fresnel = f0 + (1 - f0) * std::pow(1 + double(ray.direction.y), 5);
    // albedo/pi * pi L. alpha is clamped to 1e-3, whose tail misses the wall by less than 1e-3.
    const double truth = fresnel * 0.5 * 2;
    EXPECT_NEAR(l.mean(), truth, z_limit * l.standard_error() + 2e-3 * truth) << metal;
  }
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
  const Lit lit(std::move(scene));
  for (const float height : {0.01F, 0.3F, 0.76F, 3.0F}) {
    const Ray ray = ray_to({1, height, 0}, {0, 0, 0});
    const auto hit = lit.intersector.closest(ray);
    ASSERT_TRUE(hit);
    const Surface surface = make_surface(lit.scene, ray, *hit);
    EXPECT_GT(surface.ns.dot(-ray.direction), 0);
    EXPECT_GT(surface.ns.dot(surface.ng), 0);
    EXPECT_NEAR(surface.ns.length(), 1, 1e-6F);
    // Of the cosine around ns the share (1 - ns.ng)/2 lies below ng and is lost.
    const double lost = 0.5 * (1 - double(surface.ns.dot(surface.ng)));
    const Accumulator l = path_samples(lit, ray, {}, 20000);
    EXPECT_LT(std::abs(z_score(l, 1 - lost)), z_limit) << height;
  }
}

TEST(Probe, ClosedForms) {
  Scene scene;
  const int black = add_lambert(scene, Rgb(0, 0, 0));
  add_mesh(scene, make_quad({-1, -5, -1}, {0, 0, 2}, {2, 0, 0}, black));
  scene.environment = uniform_environment({3, 3, 3});
  scene.lights.push_back(PointLight{V3f(0, 2, 0), Rgb(8, 8, 8)});
  const Lit lit(std::move(scene));
  const V3f up(0, 1, 0);
  ProbeParams params;
  params.samples = 20000;
  const auto results = probe_scene(lit.scene, lit.intersector, lit.lights, {{V3f(0, 0, 0), up}}, params);
  const double truth = 3 * double(pi) + 8.0 / 4;
  ASSERT_EQ(results.size(), 1U);
  EXPECT_LT(std::abs(double(results[0].e.x) - truth), z_limit * double(results[0].standard_error.x));
  EXPECT_LT(results[0].standard_error.x, 0.02 * truth);
}

TEST(Probe, FurnaceAndIndirectOnly) {
  const Lit lit(furnace(0.5F, Rgb(1, 1, 1)));
  const V3f up(0, 1, 0);
  std::vector<ProbePoint> points{{V3f(0, 0, 0), up}, {V3f(0.3F, -1, 0.2F), up}, {V3f(0.5F, 0.5F, 1), V3f(0, 0, -1)}};
  ProbeParams params;
  params.samples = 20000;
  for (const bool indirect_only : {false, true}) {
    params.indirect_only = indirect_only;
    for (const ProbeResult& r : probe_scene(lit.scene, lit.intersector, lit.lights, points, params)) {
      // L = 2 everywhere, of which 1 comes straight from the walls.
      const double truth = double(pi) * (indirect_only ? 1 : 2);
      EXPECT_LT(std::abs(double(r.e.y) - truth), z_limit * double(r.standard_error.y) + 1e-6 * truth);
    }
  }
}

// Scaled errors of many points must look like unit normals: the sum of squares is chi-square.
TEST(Probe, StandardErrorsAreHonest) {
  const Lit lit(furnace(0.7F, Rgb(1, 1, 1)));
  std::vector<ProbePoint> points;
  RandomStream random(5, StreamPurpose::test, 0);
  for (int i = 0; i < 400; ++i) points.push_back({sample_sphere(random.next2()) * 0.5F, sample_sphere(random.next2())});
  ProbeParams params;
  params.samples = 256;
  double chi2 = 0;
  for (const ProbeResult& r : probe_scene(lit.scene, lit.intersector, lit.lights, points, params)) {
    const double z = (double(r.e.x) - double(pi) / 0.3) / double(r.standard_error.x);
    chi2 += z * z;
  }
  // 400 degrees of freedom have a standard deviation of 28; the estimates' own skew adds some 5 %.
  EXPECT_NEAR(chi2, 400, 4 * 28 + 20);
}

TEST(Probe, DoesNotDependOnThreads) {
  const Lit lit(small_room());
  std::vector<ProbePoint> points(10, {V3f(0, 0, 0), V3f(0, 1, 0)});
  ProbeParams params;
  params.samples = 16;
  params.threads = 1;
  const auto a = probe_scene(lit.scene, lit.intersector, lit.lights, points, params);
  params.threads = 2;
  const auto b = probe_scene(lit.scene, lit.intersector, lit.lights, points, params);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(a[i].e, b[i].e);
  EXPECT_NE(a[0].e, a[1].e);  // points have streams of their own
}

}  // namespace
}  // namespace ivory
