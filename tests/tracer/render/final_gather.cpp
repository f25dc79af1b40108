// Final gather over grids made by hand, against closed forms and the path tracer.
#include "tracer/render/final_gather.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/lit_scene.h"
#include "tracer/core/sampling.h"

namespace ivory {
namespace {

// Grids made by hand, so that these tests judge the renderer alone: uniform light of radiance L gives
// E = pi L for every normal.
IrradianceGrid uniform_grid(float radiance) {
  IrradianceGrid grid;
  grid.frame.size = V3i(2, 2, 2);
  // Within the walls: vertices on them see nothing.
  grid.frame.origin_m = V3f(-0.9F, -0.9F, -0.9F);
  grid.frame.spacing_m = V3f(1.8F, 1.8F, 1.8F);
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
  const LitScene lit = make_lit_scene(furnace(rho, Rgb(2, 2, 2)));
  const IrradianceGrid grid = uniform_grid(2 * rho / (1 - rho));
  for (const Guard guard : {Guard::rays, Guard::off}) {
    for (const int rays : {0, 1, 7}) {
      for (const bool indirect_only : {false, true}) {
        GatherParams params;
        params.gather_rays = rays;
        params.indirect_only = indirect_only;
        GridLight light;
        light.grid = &grid;
        light.lookup.guard = guard;
        const Ray ray = ray_to({0.1F, 0.2F, 0.3F}, {-1, 0.5F, 0.4F});
        const Accumulator l =
            collect(20000, [&](RandomStream& random) { return trace_gather(lit, light, ray, params, random); });
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
  const LitScene lit = make_lit_scene(std::move(scene));
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
        100000, [&](RandomStream& random) { return trace_gather(lit, light, ray, params, random); }, 1);
    EXPECT_LT(std::abs(z_score(l, path)), z_limit);
  }
}

TEST(FinalGather, EvenSamplesAreUnbiased) {
  const LitScene lit = make_lit_scene(small_room());
  const IrradianceGrid grid = uniform_grid(0.5F);
  GridLight light;
  light.grid = &grid;
  light.lookup.guard = Guard::off;
  GatherParams params;
  params.gather_rays = 3;
  const View view = test_view(8, 6);
  Accumulator even;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    RenderParams render;
    render.samples = 8;
    render.seed = seed;
    const Film film = render_gather(lit, indirect_light(lit, light), view, render, params);
    double mean = 0;
    for (const Rgb& pixel : film.pixels) mean += double(pixel.y) / double(film.pixels.size());
    even.add(mean);
  }
  const Accumulator independent = collect(100000, [&](RandomStream& random) {
    Ray ray = make_ray(view, random.next2() * V2f(8, 6));
    ray.coverage_seed = random.next_u32();
    return trace_gather(lit, light, ray, params, random);
  });
  EXPECT_LT(std::abs(z_score(even, independent)), z_limit);
}

// With a black grid, direct shows direct light and gather adds exactly one bounce.
TEST(FinalGather, GatherAddsOneBounceToDirect) {
  Scene scene = small_room();
  scene.materials[2] = scene.materials[0];  // all diffuse: specular chains add bounces of their own
  const LitScene lit = make_lit_scene(std::move(scene));
  const IrradianceGrid grid = uniform_grid(0);
  GridLight light;
  light.grid = &grid;
  for (const V3f& target : {V3f(-0.2F, -0.99F, 0.3F), V3f(-1, 0, 0.2F)}) {
    const Ray ray = ray_to({0, 0.2F, 0.9F}, target);
    for (const int rays : {0, 3}) {
      GatherParams params;
      params.gather_rays = rays;
      params.near_bounces = 0;  // the whole room lies within the grid's only voxel
      PathParams path;
      path.max_bounces = rays > 0 ? 2 : 1;
      const Accumulator l =
          collect(100000, [&](RandomStream& random) { return trace_gather(lit, light, ray, params, random); });
      EXPECT_LT(std::abs(z_score(l, path_samples(lit, ray, path, 100000, 1))), z_limit) << rays;
    }
  }
}

// Where black stored light stands far apart, nothing is read: each of near_bounces hits in a row adds a bounce of its
// own.
TEST(FinalGather, GoesOnFromHitsNearerThanAVoxel) {
  Scene scene = small_room();
  scene.materials[2] = scene.materials[0];
  const LitScene lit = make_lit_scene(std::move(scene));
  const IndirectLight black([](const Surface&) { return Rgb(0, 0, 0); }, [](const V3f&) { return 100.0F; });
  const Ray ray = ray_to({0, 0.2F, 0.9F}, {-0.2F, -0.99F, 0.3F});
  for (const int near : {1, 2}) {
    GatherParams params;
    params.gather_rays = 1;
    params.near_bounces = near;
    PathParams path;
    path.max_bounces = 2 + near;
    const Accumulator l =
        collect(100000, [&](RandomStream& random) { return trace_gather(lit, black, ray, params, random); });
    EXPECT_LT(std::abs(z_score(l, path_samples(lit, ray, path, 100000, 1))), z_limit) << near;
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
    const LitScene lit = make_lit_scene(std::move(scene));
    const IrradianceGrid grid = uniform_grid(2);
    GridLight light;
    light.grid = &grid;
    light.lookup.guard = Guard::off;
    const Ray ray = ray_to({0, 0.5F, 0.5F}, {0, 0, -0.2F});
    const Accumulator l =
        collect(100000, [&](RandomStream& random) { return trace_gather(lit, light, ray, {}, random); });
    const double f0 = metal ? 1 : 0.04;
    const double fresnel = f0 + (1 - f0) * std::pow(1 + double(ray.direction.y), 5);
    // albedo/pi * pi L. alpha is clamped to 1e-3, whose tail misses the wall by less than 1e-3.
    const double truth = fresnel * 0.5 * 2;
    EXPECT_NEAR(l.mean(), truth, z_limit * l.standard_error() + 2e-3 * truth) << metal;
  }
}

}  // namespace
}  // namespace ivory
