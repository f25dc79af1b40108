// Direct light by cosine lobes against closed forms, against Monte Carlo on the same spheres, and its Monte Carlo twin
// against the path tracer.
#include "tracer/render/lobes.h"

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"
#include "tools/stability/scene_builder.h"
#include "tracer/lights/sphere.h"
#include "tracer/render/path_tracer.h"

namespace ivory {
namespace {

const LobeTable& table() {
  static const LobeTable built = make_lobe_table();
  return built;
}

struct Numbers {
  std::uint32_t state = 99;
  float next() {
    state = state * 1664525U + 1013904223U;
    return float(state >> 8U) * 0x1p-24F;
  }
};

LobeReflectance lambert(const V3f& n, float albedo) {
  LobeReflectance r;
  r.ns = n;
  r.diffuse = Rgb(albedo, albedo, albedo) / pi;
  return r;
}

LobeReflectance phong(const V3f& n, const V3f& mirror, float exponent) {
  LobeReflectance r;
  r.ns = n;
  r.glossy[0] = {mirror.normalized(), exponent, Rgb(1, 1, 1) * ((exponent + 2) / (2 * pi))};
  r.glossy_count = 1;
  return r;
}

// A point at the origin under one light, its occluders given; a scene for the signature alone.
struct LitPoint {
  LitScene lit = make_lit_scene(Scene());
  LobeScene lobes;

  explicit LitPoint(const SphereLight& light) {
    lobes.table = table();
    lobes.lights = {light};
  }
  Rgb at(const LobeReflectance& r, const LobeParams& params, std::uint64_t stream = 0,
         const V3f& p = V3f(0, 0, 0)) const {
    RandomStream random(3, StreamPurpose::test, stream);
    Surface surface;
    surface.p = p;
    surface.ng = V3f(0, 1, 0);
    return lobe_direct_light(lobes, lit, surface, r, params, random);
  }
};

TEST(LobeDirect, AnUnshadowedLightOnAMattSurfaceIsExact) {
  for (const float radius : {0.01F, 0.3F, 1.0F}) {
    for (const V3f& center : {V3f(0, 3, 0), V3f(1.5F, 2, 0.5F)}) {
      const LitPoint setup({center, radius, Rgb(2, 3, 4)});
      const Rgb found = setup.at(lambert(V3f(0, 1, 0), 0.5F), {});
      // L = albedo/pi E, E = pi L (r/d)^2 cos(theta) while the ball is above the horizon.
      const float d = center.length();
      const float e = pi * radius * radius / (d * d) * center.y / d;
      for (unsigned c = 0; c < 3; ++c) {
        const float expected = 0.5F / pi * e * setup.lobes.lights[0].radiance_nits[c];
        EXPECT_NEAR(found[c] / expected, 1, 1e-4F);
      }
    }
  }
}

TEST(LobeDirect, ACoveredLightIsExactlyDark) {
  LitPoint setup({V3f(0.5F, 3, 0), 0.5F, Rgb(1, 1, 1)});
  setup.lobes.occluders = make_sphere_groups({{V3f(0.2F, 1, 0.1F), 0.25F}, {V3f(0.1F, 1, -0.1F), 0.25F}});
  LobeParams params;
  for (params.mask_depth = 1; params.mask_depth <= max_mask_depth; ++params.mask_depth) {
    EXPECT_EQ(setup.at(lambert(V3f(0, 1, 0), 1), params).x, 0);
    for (const float e : {1.0F, 30.0F, 3000.0F})
      EXPECT_EQ(setup.at(phong(V3f(0, 1, 0), V3f(0.5F, 3, 0), e), params).x, 0);
  }
}

TEST(LobeDirect, LightsBelowTheHorizonOrAroundThePointGiveNothing) {
  EXPECT_EQ(LitPoint({V3f(0, -3, 0), 1, Rgb(1, 1, 1)}).at(lambert(V3f(0, 1, 0), 1), {}).x, 0);
  EXPECT_EQ(LitPoint({V3f(0, 0.5F, 0), 1, Rgb(1, 1, 1)}).at(lambert(V3f(0, 1, 0), 1), {}).x, 0);
}

// Random clusters of spheres in front of random lights; errors over the unshadowed light.
struct Errors {
  double rms = 0;
  double bias = 0;
};
Errors errors_against_rays(float exponent, int depth, const MaskRule rule = MaskRule::center) {
  Numbers u;
  double squares = 0;
  double sum = 0;
  constexpr int scenes = 120;
  for (int i = 0; i < scenes; ++i) {
    const V3f d = V3f(u.next() - 0.5F, 0.3F + u.next(), u.next() - 0.5F).normalized();
    LitPoint setup({d * 4.0F, 4 * (0.03F + 0.25F * u.next()), Rgb(1, 1, 1)});
    std::vector<Sphere> occluders;
    const int count = 1 + int(12 * u.next());
    for (int k = 0; k < count; ++k) {
      const V3f offset(u.next() - 0.5F, u.next() - 0.5F, u.next() - 0.5F);
      occluders.push_back({d * (1 + 2 * u.next()) + offset * setup.lobes.lights[0].radius_m,
                           0.3F * u.next() * setup.lobes.lights[0].radius_m});
    }
    setup.lobes.occluders = make_sphere_groups(occluders);
    const V3f n(0, 1, 0);
    const V3f mirror = d + V3f(u.next() - 0.5F, 0, u.next() - 0.5F) * 0.3F;
    const LobeReflectance r = exponent > 0 ? phong(n, mirror, exponent) : lambert(n, 1);
    LobeParams params;
    params.mask_depth = depth;
    params.mask_rule = rule;
    LobeParams rays;
    rays.shadows = LobeShadows::spheres;
    rays.shadow_rays = 64 * 64;
    LitPoint open(setup.lobes.lights[0]);
    const double truth = double(setup.at(r, rays, std::uint64_t(i)).x);
    // At the highlight's middle: beside it there is next to no light to be wrong by.
    const LobeReflectance facing = exponent > 0 ? phong(n, d, exponent) : r;
    const double unshadowed = double(open.at(facing, rays, std::uint64_t(i)).x);
    const double error = (double(setup.at(r, params).x) - truth) / unshadowed;
    squares += error * error / scenes;
    sum += error / scenes;
  }
  return {std::sqrt(squares), sum};
}

TEST(LobeDirect, ShadowsOnMattSurfacesAgreeWithRays) {
  // The mask's resolution is the error; rays add 64^-1.5 = 2e-3 of an edge.
  EXPECT_LT(errors_against_rays(0, 3).rms, 0.025);
  EXPECT_LT(errors_against_rays(0, 4).rms, 0.01);
  EXPECT_LT(errors_against_rays(0, 5).rms, 0.004);
  EXPECT_LT(std::abs(errors_against_rays(0, 4).bias), 0.003);
}

TEST(LobeDirect, ShadowsOnGlossySurfacesAgreeWithRays) {
  // Highlights of all widths: wider than the light, as wide, narrower (where it is split).
  for (const float exponent : {10.0F, 100.0F, 1000.0F}) {
    EXPECT_LT(errors_against_rays(exponent, 5).rms, 0.05) << exponent;
    EXPECT_LT(std::abs(errors_against_rays(exponent, 5).bias), 0.02) << exponent;
  }
}

TEST(LobeDirect, PaperRulesAreBiasedBothWays) {
  EXPECT_GT(errors_against_rays(0, 4, MaskRule::inside).bias, 0.02);
  EXPECT_LT(errors_against_rays(0, 4, MaskRule::touched).bias, -0.02);
}

// A light of exponent 98 (11.5 degrees) in highlights wider than it, as wide and narrower: one lobe for the light would
// smear the ball's edge and raise its middle.
TEST(LobeDirect, SplittingTheLightKeepsReflectionsSharp) {
  const LitPoint setup({V3f(0, 4, 0), 0.8F, Rgb(1, 1, 1)});
  LobeParams rays;
  rays.shadows = LobeShadows::spheres;
  rays.shadow_rays = 128 * 128;
  for (const float exponent : {25.0F, 100.0F, 400.0F}) {
    double worst[2] = {0, 0};
    const double scale = double(setup.at(phong(V3f(0, 1, 0), V3f(0, 1, 0), exponent), rays).x);
    for (int i = 0; i <= 20; ++i) {
      const LobeReflectance r = phong(V3f(0, 1, 0), V3f(0.02F * float(i), 1, 0), exponent);
      const double truth = double(setup.at(r, rays).x);
      for (const int split : {0, 3}) {
        LobeParams params;
        params.max_split_level = split;
        double& w = worst[split == 0 ? 0 : 1];
        w = std::max(w, std::abs(double(setup.at(r, params).x) - truth) / scale);
      }
    }
    // 64 leaves at most: for the narrowest highlight their own shapes begin to show.
    EXPECT_LT(worst[1], 0.02) << exponent;
    EXPECT_GT(worst[0], 2 * worst[1]) << exponent;
  }
}

TEST(LobeDirect, DroppedProductsStayBelowTheThreshold) {
  LitPoint setup({V3f(0.5F, 3, 0), 0.6F, Rgb(1, 1, 1)});
  setup.lobes.occluders = make_sphere_groups({{V3f(0.25F, 1, 0.1F), 0.12F}, {V3f(0.1F, 1, -0.1F), 0.07F}});
  for (const float exponent : {0.0F, 20.0F, 500.0F}) {
    const LobeReflectance r =
        exponent > 0 ? phong(V3f(0, 1, 0), V3f(0.5F, 3, 0.5F), exponent) : lambert(V3f(0, 1, 0), 1);
    LobeParams exact;
    exact.mask_depth = 5;
    exact.threshold = 0;
    const float all = setup.at(r, exact).x;
    LobeParams dropped = exact;
    dropped.threshold = 1e-3F;
    EXPECT_NEAR(setup.at(r, dropped).x / all, 1, 0.02F) << exponent;
    // Everything dropped: a lit fraction by solid angle is left, neither darkness nor the full light.
    dropped.threshold = 1;
    EXPECT_NEAR(setup.at(r, dropped).x / all, 1, 0.5F) << exponent;
  }
}

// The Monte Carlo twin on the mesh and the path tracer are two estimators of the same picture where surfaces are matt.
TEST(LobeDirect, TwinOnTheMeshAgreesWithThePathTracer) {
  Scene scene;
  const int white = add_lambert(scene, Rgb(0.8F, 0.8F, 0.8F));
  add_mesh(scene, make_quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, white));
  Mesh box = make_room(V3f(-0.3F, 0.5F, -0.3F), V3f(0.3F, 0.9F, 0.3F), white);
  for (auto& t : box.triangles) std::swap(t.y, t.z);
  add_mesh(scene, box);
  add_sphere_light(scene, {V3f(0.3F, 2.5F, 0.2F), 0.4F, Rgb(10, 10, 10)}, "test");
  const LitScene lit = make_lit_scene(std::move(scene));
  LobeScene lobes;
  lobes.lights = lit.scene->sphere_lights;
  LobeParams params;
  params.shadows = LobeShadows::mesh;
  params.shadow_rays = 16;
  PathParams direct;
  direct.max_bounces = 1;
  for (const V3f& target : {V3f(1, 0, 0.5F), V3f(0.35F, 0, 0), V3f(-0.3F, 0, 0.1F), V3f(0.1F, 0.9F, 0.1F)}) {
    Ray ray;
    ray.origin = V3f(1.5F, 1.2F, 1.5F);
    ray.direction = (target - ray.origin).normalized();
    const std::optional<Hit> hit = lit.intersector.closest(ray);
    ASSERT_TRUE(hit);
    const Surface surface = make_surface(*lit.scene, ray, *hit);
    const LobeReflectance r = make_lobe_reflectance(*lit.scene, *hit, surface, -ray.direction);
    RandomStream random(5, StreamPurpose::test, 0);
    Accumulator twin;
    Accumulator path;
    for (int i = 0; i < 4000; ++i) {
      twin.add(double(lobe_direct_light(lobes, lit, surface, r, params, random).y));
      for (int k = 0; k < 4; ++k) path.add(double(trace_path(lit, ray, direct, random).y));
    }
    // 0.2 % beside: the light's mesh is a ball to 0.1 %.
    EXPECT_LE(std::abs(twin.mean() - path.mean()),
              z_limit * std::hypot(twin.standard_error(), path.standard_error()) + 2e-3 * path.mean());
  }
}

TEST(LobeReflectance, PhongConservesEnergyTowardsTheNormal) {
  // f = ks (e+2)/(2 pi) (r.w)^e: at normal incidence the albedo is ks exactly.
  for (const float e : {0.0F, 5.0F, 200.0F}) {
    const ReflectanceLobes lobes = make_reflectance_lobes(table(), phong(V3f(0, 1, 0), V3f(0, 1, 0), e));
    ASSERT_EQ(lobes.count, 1);
    EXPECT_NEAR(lobes.lobes[0].color.x * lobe_integral(lobes.lobes[0].lobe), 1, 3e-3F);
  }
}

TEST(LobeReflectance, PhongIsAsWideAsTheMicrofacetLobe) {
  EXPECT_EQ(phong_exponent(1), 0);
  EXPECT_EQ(phong_exponent(0), max_lobe_exponent);
  // Where the half vector has turned by delta, GGX (its Gaussian limit) has fallen by exp(-delta^2/alpha^2) and the
  // reflected direction has turned by 2 delta: cos(2 delta)^e is the same for small alpha.
  const float alpha = 0.05F;
  const float delta = 0.02F;
  EXPECT_NEAR(std::pow(std::cos(2 * delta), phong_exponent(alpha)), std::exp(-delta * delta / (alpha * alpha)), 2e-3F);
}

TEST(LobeReflectance, LafortunesMirrorLobeIsPhongs) {
  Scene scene;
  Material material;
  material.metallic = 0;
  material.base_color = Rgb(0.5F, 0.25F, 0);
  material.lafortune = {{Rgb(0.3F, 0.3F, 0.3F), V3f(-1, -1, 1), 20, false},
                        {Rgb(1, 1, 1), V3f(0.2F, 0.2F, 0.9F), 3, true}};
  scene.materials.push_back(material);
  add_mesh(scene, make_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0));
  const Intersector intersector(scene);
  Ray ray;
  ray.origin = V3f(1, 1, 0.3F);
  ray.direction = (V3f(0, 0, 0.1F) - ray.origin).normalized();
  const Hit hit = *intersector.closest(ray);
  const LobeReflectance r = make_lobe_reflectance(scene, hit, make_surface(scene, ray, hit), -ray.direction);
  ASSERT_EQ(r.glossy_count, 2);
  const V3f mirror(ray.direction.x, -ray.direction.y, ray.direction.z);
  EXPECT_GT(r.glossy[0].axis.dot(mirror), 1 - 1e-6F);
  EXPECT_NEAR(r.glossy[0].color.x, 0.3F, 1e-5F);
  EXPECT_NEAR(r.diffuse.y, 0.25F / pi, 1e-6F);
  // Reciprocity: f(wo, wi) = f(wi, wo), C being symmetric.
  const V3f wi = V3f(-0.4F, 0.8F, 0.2F).normalized();
  Ray other;
  other.origin = V3f(0, 0, 0.1F) + wi;
  other.direction = -wi;
  const Hit back = *intersector.closest(other);
  const LobeReflectance q = make_lobe_reflectance(scene, back, make_surface(scene, other, back), wi);
  const Rgb there = eval(r, wi) / wi.y;
  const Rgb again = eval(q, -ray.direction) / -ray.direction.y;
  for (unsigned c = 0; c < 3; ++c) EXPECT_NEAR(there[c], again[c], 1e-4F);
}

}  // namespace
}  // namespace ivory
