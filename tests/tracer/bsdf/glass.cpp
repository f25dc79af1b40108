// Glass, KHR_materials_transmission: a share of the light passes straight through, for every kind of ray.
#include <cmath>

#include <gtest/gtest.h>

#include "grid/field/resolve.h"
#include "tests/support/gltf_check.h"
#include "tests/support/lit_scene.h"
#include "tracer/bake/field/baker.h"
#include "tracer/core/surface.h"
#include "tracer/render/probe.h"

namespace ivory {
namespace {

using nlohmann::json;

constexpr float transmission = 0.9F;
constexpr double half_window_m = 0.5;
constexpr double window_z_m = 1;

int add_glass(Scene& scene) {
  const int glass = add_lambert(scene, Rgb(0, 0, 0));
  scene.materials[std::size_t(glass)].transmission = transmission;
  return glass;
}

// A black room, 2 m a side, whose wall at z = 1 has a window of 1 m x 1 m.
Scene dark_room() {
  Scene scene;
  const int black = add_lambert(scene, Rgb(0, 0, 0), Rgb(0, 0, 0), true);
  Mesh box = make_room(V3f(-1, -1, -1), V3f(1, 1, 1), black);
  std::erase_if(box.triangles, [&](const auto& t) {
    return box.positions[t.x].z > 0 && box.positions[t.y].z > 0 && box.positions[t.z].z > 0;
  });
  add_mesh(scene, box);
  add_mesh(scene, make_quad({-1, -1, 1}, {2, 0, 0}, {0, 0.5F, 0}, black));
  add_mesh(scene, make_quad({-1, 0.5F, 1}, {2, 0, 0}, {0, 0.5F, 0}, black));
  add_mesh(scene, make_quad({-1, -0.5F, 1}, {0.5F, 0, 0}, {0, 1, 0}, black));
  add_mesh(scene, make_quad({0.5F, -0.5F, 1}, {0.5F, 0, 0}, {0, 1, 0}, black));
  add_mesh(scene, make_quad({-0.5F, -0.5F, 1}, {1, 0, 0}, {0, 1, 0}, add_glass(scene)));
  return scene;
}

// E(+z) at p over the radiance in the window: pi times the form factor from a point to a parallel rectangle with a
// corner above it (Siegel & Howell), signed over the window's four corners.
double window_irradiance(const V3d& p) {
  const double z = window_z_m - p.z;
  const auto corner = [&](double x, double y) {
    const double a = x / z;
    const double b = y / z;
    const double sa = std::sqrt(1 + a * a);
    const double sb = std::sqrt(1 + b * b);
    return 0.5 * (a / sa * std::atan(b / sa) + b / sb * std::atan(a / sb));
  };
  return corner(half_window_m - p.x, half_window_m - p.y) - corner(-half_window_m - p.x, half_window_m - p.y) -
         corner(half_window_m - p.x, -half_window_m - p.y) + corner(-half_window_m - p.x, -half_window_m - p.y);
}

TEST(Glass, LetsTheSkyIntoARoomForPaths) {
  Scene scene = dark_room();
  scene.environment = uniform_environment({1, 2, 3});
  const LitScene lit = make_lit_scene(std::move(scene));
  ProbeParams params;
  params.samples = 100000;
  for (const V3f& p : {V3f(0, 0, -0.9F), V3f(0.4F, -0.2F, 0.2F)}) {
    const ProbeResult result = probe_scene(lit, {{p, V3f(0, 0, 1)}}, params)[0];
    const double truth = 2 * double(transmission) * window_irradiance(V3d(p));
    EXPECT_LT(std::abs(double(result.e.y) - truth), z_limit * double(result.standard_error.y)) << p.z << " " << truth;
    // Four standard errors tell glass from a hole.
    EXPECT_LT(double(result.standard_error.y) * 8, truth / 9);
  }
}

// The mean of F.z over a box, which the cells of 2 x 2 x 2 vertices tile; all light comes from +z, so that it is E.
TEST(Glass, LetsTheSkyIntoARoomForPhotons) {
  Scene scene = dark_room();
  scene.environment = uniform_environment({1, 2, 3});
  const LitScene lit = make_lit_scene(std::move(scene));
  constexpr float side_m = 0.8F;
  Accumulator photons;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    GridBakeParams params;
    GridFrame frame;
    frame.size = V3i(2, 2, 2);
    frame.spacing_m = V3f(side_m, side_m, side_m) / 2;
    frame.origin_m = V3f(-side_m, -side_m, -side_m) / 4;
    params.frame = frame;
    params.photons = 100000;
    params.guard = Guard::off;
    params.include_direct = true;
    params.seed = seed;
    const IrradianceGrid grid = resolve(bake_grid_sums(lit, params));
    double mean = 0;
    for (std::size_t vertex = 0; vertex < 8; ++vertex) mean += double(grid.at(vertex)[2 * 3 + 1]) / 8;
    photons.add(mean);
  }
  // The midpoint rule: E is smooth in the box, which stays 0.6 m from the window; 16 and 32 steps agree to 1e-4.
  constexpr int steps = 16;
  double truth = 0;
  for (int i = 0; i < steps * steps * steps; ++i) {
    const V3d cell(i % steps, i / steps % steps, i / (steps * steps));
    truth += window_irradiance(((cell + V3d(0.5)) / steps - V3d(0.5)) * double(side_m));
  }
  truth *= 2 * double(transmission) / (steps * steps * steps);
  EXPECT_LT(std::abs(z_score(photons, truth)), z_limit) << photons.mean() << " +- " << photons.standard_error();
  EXPECT_LT(photons.standard_error() * 8, truth / 9);
}

TEST(Glass, DimsTheSunAndTheViewAlike) {
  Scene scene = dark_room();
  scene.lights.emplace_back(DirectionalLight{V3f(0, 0.1F, -1).normalized(), Rgb(10, 10, 10)});
  scene.environment = uniform_environment({0, 0, 0});
  scene.environment->radiance.assign(scene.environment->radiance.size(), Rgb(0.5F, 0.5F, 0.5F));
  const LitScene lit = make_lit_scene(std::move(scene));
  // Shadow rays are dimmed, not stopped by chance: exact to rounding.
  EXPECT_NEAR(lit.intersector.transmittance(ray_to({0, 0, 0}, {0.1F, 0, 1})), transmission, 1e-6F);
  EXPECT_EQ(lit.intersector.transmittance(ray_to({0, 0, 0}, {0.8F, 0, 1})), 0);
  EXPECT_TRUE(lit.intersector.has_coverage());
  const Accumulator seen = collect(100000, [&](RandomStream& random) {
    Ray ray = ray_to({0, 0, 0}, {0.1F, 0.2F, 1});
    ray.coverage_seed = random.next_u32();
    return trace_path(lit, ray, {}, random);
  });
  EXPECT_LT(std::abs(z_score(seen, 0.5 * double(transmission))), z_limit);
}

// Coverage is what alpha leaves, times what the dielectric's part does not transmit; lamps of glass stay whole.
TEST(Glass, CoverageFollowsTextureMetalAndAlpha) {
  Scene scene;
  const int glass = add_glass(scene);
  add_mesh(scene, make_quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, glass));
  Image image;
  image.width = image.height = 1;
  image.rgba = {51, 255, 102, 255};  // r 0.2, b 0.4
  scene.images.push_back(image);
  scene.textures.emplace_back().image = 0;
  const auto coverage = [&] { return coverage_at(scene, 0, 0, V2f(0.3F, 0.3F)); };
  Material& m = scene.materials[std::size_t(glass)];
  EXPECT_NEAR(coverage(), 0.1F, 1e-6F);
  m.transmission_texture.texture = 0;
  EXPECT_NEAR(coverage(), 1 - 0.9F * 0.2F, 1e-6F);
  m.metallic = 0.5F;
  EXPECT_NEAR(coverage(), 1 - 0.9F * 0.2F * 0.5F, 1e-6F);
  m.metallic_roughness_texture.texture = 0;
  EXPECT_NEAR(coverage(), 1 - 0.9F * 0.2F * 0.8F, 1e-6F);
  m.alpha_mode = AlphaMode::blend;
  m.alpha = 0.5F;
  EXPECT_NEAR(coverage(), 0.5F * (1 - 0.9F * 0.2F * 0.8F), 1e-6F);
  m.alpha_mode = AlphaMode::mask;
  EXPECT_NEAR(coverage(), 1 - 0.9F * 0.2F * 0.8F, 1e-6F);
  m.alpha_cutoff = 0.6F;
  EXPECT_EQ(coverage(), 0);
  m.alpha_mode = AlphaMode::opaque;
  m.emission = Rgb(1, 1, 1);
  EXPECT_EQ(coverage(), 1);
}

GltfBuilder glass_file(const json& extension) {
  GltfBuilder builder;
  builder.use_extension("KHR_materials_transmission");
  builder.root["extensionsRequired"] = {"KHR_materials_transmission"};
  builder.root["materials"] = {{{"name", "pane"}, {"extensions", {{"KHR_materials_transmission", extension}}}},
                               {{"name", "bowl"}, {"extensions", {{"KHR_materials_transmission", extension}}}}};
  builder.root["images"] = {
      {{"uri",
        "data:image/png;base64,"
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg=="}}};
  builder.root["textures"] = {{{"source", 0}}};
  const int p = builder.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const int t = builder.add(std::vector<V2f>{{0, 0}, {1, 0}, {0, 1}});
  const json primitive = {{"attributes", {{"POSITION", p}, {"TEXCOORD_0", t}}}, {"material", 0}};
  builder.add_node({{"mesh", builder.add_mesh(primitive)}});
  return builder;
}

TEST(Glass, IsReadFromFilesWithOneWarning) {
  const LoadedScene loaded =
      load(glass_file({{"transmissionFactor", 0.75}, {"transmissionTexture", {{"index", 0}}}}), "glass");
  EXPECT_EQ(loaded.scene.materials[0].transmission, 0.75F);
  EXPECT_EQ(loaded.scene.materials[0].transmission_texture.texture, 0);
  EXPECT_EQ(loaded.scene.images.size(), 1U);
  EXPECT_TRUE(has_warning(loaded, "straight through, without refraction and tint"));
  EXPECT_EQ(loaded.warnings.size(), 1U);

  EXPECT_EQ(load(glass_file(json::object()), "no_glass").warnings.size(), 0U);
  EXPECT_NE(error_of(glass_file({{"transmissionFactor", 1.5}}), "too_clear").find("transmissionFactor"),
            std::string::npos);
  GltfBuilder lamp = glass_file({{"transmissionFactor", 1}});
  lamp.root["materials"][0]["emissiveFactor"] = {1, 1, 1};
  EXPECT_TRUE(has_warning(load(lamp, "glass_lamp"), "taken as opaque"));
}

}  // namespace
}  // namespace ivory
