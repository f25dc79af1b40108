// Guided bakes: photons that a pilot sends, aims and splits leave the E that even ones do, the same bytes whoever
// traces them, and a ledger that balances.
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "grid/field/resolve.h"
#include "tests/support/emissive_texture.h"
#include "tests/support/statistics.h"
#include "tools/stability/scene_builder.h"
#include "tracer/bake/field/baker.h"
#include "tracer/bake/field/pilot.h"
#include "tracer/lights/sphere.h"
#include "tracer/render/photons/tracer.h"

namespace ivory {
namespace {

// Open towards +z, with a lot of ground in front of it, and a white wall across the yard.
Scene yard(float half_side_m, bool mirror = false) {
  Scene scene;
  const int wall = add_lambert(scene, Rgb(0.6F, 0.5F, 0.4F), Rgb(0, 0, 0), true);
  const int ground = add_lambert(scene, Rgb(0.4F, 0.4F, 0.3F));
  add_mesh(scene, make_quad({-3, 0, -3}, {6, 0, 0}, {0, 3, 0}, wall));
  add_mesh(scene, make_quad({-3, 0, -3}, {0, 3, 0}, {0, 0, 6}, wall));
  add_mesh(scene, make_quad({3, 0, -3}, {0, 0, 6}, {0, 3, 0}, wall));
  add_mesh(scene, make_quad({-3, 3, -3}, {0, 0, 6}, {6, 0, 0}, wall));
  const int white = add_lambert(scene, Rgb(0.9F, 0.9F, 0.9F), Rgb(0, 0, 0), true);
  if (mirror) {
    scene.materials[std::size_t(white)].metallic = 1;
    scene.materials[std::size_t(white)].specular = 1;
    scene.materials[std::size_t(white)].roughness = 0.1F;
  }
  add_mesh(scene, make_quad({4, 0, 9}, {-8, 0, 0}, {0, 5, 0}, white));
  const float h = half_side_m;
  add_mesh(scene, make_quad({-h, 0, -h}, {0, 0, 2 * h}, {2 * h, 0, 0}, ground));
  return scene;
}

void add_sun(Scene& scene, const V3f& direction = V3f(-0.3F, -0.8F, -0.6F)) {
  scene.lights.push_back(DirectionalLight{direction.normalized(), Rgb(1000, 1000, 1000)});
}

void add_sky(Scene& scene) {
  EnvironmentMap map;
  map.width = 8;
  map.height = 4;
  for (int i = 0; i < 32; ++i) map.radiance.push_back(i < 16 ? Rgb(100, 100 + 20 * float(i), 300) : Rgb(0, 0, 0));
  scene.environment = map;
}

GridBakeParams room_params(std::uint64_t photons) {
  GridBakeParams params;
  params.bounds = Box3f(V3f(-3, 0, -3), V3f(3, 3, 3));
  params.resolution = V3i(3, 2, 3);
  params.photons = photons;
  params.guard = Guard::off;
  return params;
}

const std::array<V3f, 3> normals{V3f(0, 1, 0), V3f(0, -1, 0), V3f(0, 0, 1)};

// For each normal E in the mean over vertices.
std::array<Accumulator, 3> mean_e(const LitScene& world, GridBakeParams params, EmissionMode mode, int seeds,
                                  std::uint64_t first_seed) {
  std::array<Accumulator, 3> out;
  params.emission = mode;
  for (int seed = 0; seed < seeds; ++seed) {
    params.seed = first_seed + std::uint64_t(seed);
    const IrradianceGrid grid = resolve(bake_grid_sums(world, params));
    for (std::size_t i = 0; i < normals.size(); ++i) {
      double mean = 0;
      for (std::size_t v = 0; v < grid.frame.vertex_count(); ++v) {
        Footprint at;
        at.count = 1;
        at.vertex[0] = std::uint32_t(v);
        at.weight[0] = 1;
        mean += double(irradiance(grid, at, normals[i], Reconstruction::optimal).y);
      }
      out[i].add(mean / double(grid.frame.vertex_count()));
    }
  }
  return out;
}

struct Case {
  std::string name;
  Scene scene;
  GridBakeParams params;
};

std::vector<Case> cases() {
  std::vector<Case> out;
  const auto add = [&](const std::string& name, Scene scene, const GridBakeParams& params) {
    out.push_back({name, std::move(scene), params});
  };
  const GridBakeParams params = room_params(40'000);
  const auto yard_with = [](float half_side_m, const std::function<void(Scene&)>& lights, bool mirror = false) {
    Scene scene = yard(half_side_m, mirror);
    lights(scene);
    return scene;
  };
  const auto lamp = [](Scene& s, bool textured) {
    const int glow = add_lambert(s, Rgb(0, 0, 0), Rgb(900, 500, 100), true);
    if (textured)
      s.materials[std::size_t(glow)].emission_texture.texture = add_texture(s, 5, 4, [](int x, int y) {
        return Texel{std::uint8_t(50 * x), std::uint8_t(x == y ? 255 : 9), 90, 255};
      });
    add_mesh(s, make_quad({-2, 4, 6}, {1.5F, 0, 0}, {0, 1, 1}, glow));
  };
  add("sun", yard_with(10, [](Scene& s) { add_sun(s); }), params);
  add("sky", yard_with(10, add_sky), params);
  add("point outside",
      yard_with(10,
                [](Scene& s) {
                  s.lights.push_back(PointLight{V3f(2, 4, 7), Rgb(900, 900, 900)});
                }),
      params);
  add("point inside",
      yard_with(10,
                [](Scene& s) {
                  s.lights.push_back(PointLight{V3f(1, 2, -1), Rgb(90, 90, 90)});
                }),
      params);
  add("spot at the ground in front",
      yard_with(10,
                [](Scene& s) {
                  SpotLight spot;
                  spot.position = V3f(0, 6, 5);
                  spot.direction = V3f(0.1F, -1, 0).normalized();
                  spot.intensity_cd = Rgb(900, 900, 900);
                  s.lights.push_back(spot);
                }),
      params);
  add("panel", yard_with(10, [&](Scene& s) { lamp(s, false); }), params);
  add("textured panel", yard_with(10, [&](Scene& s) { lamp(s, true); }), params);
  add("spherical",
      yard_with(10,
                [](Scene& s) {
                  add_sphere_light(s, {V3f(-3, 5, 8), 0.3F, Rgb(9000, 9000, 9000)}, "test");
                }),
      params);
  add("all of them",
      yard_with(10,
                [&](Scene& s) {
                  add_sun(s);
                  add_sky(s);
                  lamp(s, true);
                  for (int i = 0; i < 40; ++i)
                    s.lights.push_back(PointLight{V3f(float(i % 8) - 4, 4, float(i / 8) + 4), Rgb(9, 9, 9)});
                }),
      params);
  // From behind the room: light comes by way of the white wall or mirror across the yard alone.
  const V3f behind(0.1F, -0.5F, 0.8F);
  add("by a white wall", yard_with(10, [&](Scene& s) { add_sun(s, behind); }), params);
  add("by a mirror",
      yard_with(
          10, [&](Scene& s) { add_sun(s, behind); }, true),
      params);
  GridBakeParams direct = params;
  direct.include_direct = true;
  add("sun and sky, direct as well",
      yard_with(10,
                [](Scene& s) {
                  add_sun(s);
                  add_sky(s);
                }),
      direct);
  GridBakeParams turned = params;
  turned.rotate_y_deg = 25;
  turned.bounds = Box3f(V3f(-0.3F, 1, 0.5F), V3f(0.4F, 1.5F, 1));
  add("a tiny, turned target", yard_with(10, [](Scene& s) { add_sun(s); }), turned);
  GridBakeParams huge = params;
  huge.bounds.reset();
  add("all of the scene", yard_with(10, add_sky), huge);
  return out;
}

// 45 comparisons, of which one is beyond 4 in 350 sets of seeds.
TEST(Guided, LeavesTheLightOfEveryLamp) {
  constexpr int seeds = 6;
  for (Case& c : cases()) {
    const LitScene world = make_lit_scene(std::move(c.scene));
    const auto guided = mean_e(world, c.params, EmissionMode::guided, seeds, 1);
    const auto even = mean_e(world, c.params, EmissionMode::bounds, seeds, 101);
    for (std::size_t i = 0; i < normals.size(); ++i)
      // Errors from six seeds each: |t| of 10 degrees of freedom is beyond 6 as often as |z| beyond 4.
      EXPECT_LT(std::abs(z_score(guided[i], even[i])), 6)
          << c.name << " " << normals[i] << ": " << guided[i].mean() << " +- " << guided[i].standard_error() << " and "
          << even[i].mean() << " +- " << even[i].standard_error();
  }
}

// On a kilometre of ground as on a plot, in the same number of photons.
TEST(Guided, FindsARoomOnWideGround) {
  constexpr int seeds = 6;
  const auto sunny = [](float half_side_m) {
    Scene scene = yard(half_side_m);
    add_sun(scene);
    return make_lit_scene(std::move(scene));
  };
  const auto near = mean_e(sunny(60), room_params(200'000), EmissionMode::bounds, seeds, 101);
  for (const float half_side_m : {500.0F, 50'000.0F}) {
    const auto wide = mean_e(sunny(half_side_m), room_params(40'000), EmissionMode::guided, seeds, 1);
    for (std::size_t i = 0; i < normals.size(); ++i) {
      // Ground from 60 m on adds less than a thousandth: it is seen edge on, through the open side.
      EXPECT_LT(std::abs(wide[i].mean() - near[i].mean()),
                6 * std::hypot(wide[i].standard_error(), near[i].standard_error()) + 2e-3 * near[i].mean())
          << half_side_m << " " << normals[i] << ": " << wide[i].mean() << " and " << near[i].mean();
      EXPECT_LT(wide[i].standard_error(), 0.05 * wide[i].mean()) << half_side_m << " " << normals[i];
    }
  }
}

TEST(Guided, PartsAndThreadsGiveTheSameBits) {
  Scene scene = yard(300);
  add_sun(scene);
  add_sky(scene);
  scene.lights.push_back(PointLight{V3f(1, 2, -1), Rgb(900, 900, 900)});
  const LitScene world = make_lit_scene(std::move(scene));
  GridBakeParams params = room_params(40'000);
  params.threads = 1;
  const GridAccumulator whole = bake_grid_sums(world, params);
  EXPECT_EQ(whole.metadata.at("emission"), MetaValue(std::string("guided")));
  EXPECT_GT(std::get<double>(whole.metadata.at("pilot_reach_guided")),
            std::get<double>(whole.metadata.at("pilot_reach_unguided")));
  params.threads = 3;
  std::vector<GridAccumulator> parts;
  for (const auto& range : {std::pair<std::uint64_t, std::uint64_t>{0, 7001}, {7001, 40'000}}) {
    params.photon_range = range;
    parts.push_back(bake_grid_sums(world, params));
  }
  const GridAccumulator merged = merge(std::move(parts), {"a", "b"});
  EXPECT_EQ(merged.sums, whole.sums);
  EXPECT_EQ(merged.counters, whole.counters);
  EXPECT_EQ(merged.metadata, whole.metadata);
  // To the unit, and in the mean: what is emitted does not depend on guiding.
  const auto& c = whole.counters;
  EXPECT_EQ(c.at("ledger_emitted"), c.at("ledger_absorbed") + c.at("ledger_escaped") + c.at("ledger_terminated"));
}

// Too few photons for a pilot, and a grid that no light comes to: nothing is guided, and nothing fails.
TEST(Guided, DoesWithoutWhereNothingIsLearnt) {
  Scene scene = yard(10);
  add_sun(scene);
  const LitScene world = make_lit_scene(std::move(scene));
  const GridAccumulator few = bake_grid_sums(world, room_params(5000));
  EXPECT_EQ(std::get<std::int64_t>(few.metadata.at("pilot_photons")), 0);
  GridBakeParams below = room_params(40'000);
  below.bounds = Box3f(V3f(-3, -5, -3), V3f(3, -2, 3));
  const GridAccumulator none = bake_grid_sums(world, below);
  for (const std::int64_t sum : none.sums) ASSERT_EQ(sum, 0);
}

// Two rooms with a doorway, lit in one: photons in the dark one are split, and E there stays what it is.
TEST(Guided, DarkRoomsGetMorePhotons) {
  Scene scene;
  const int grey = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F), Rgb(0, 0, 0), true);
  add_mesh(scene, make_room(V3f(-2, 0, -6), V3f(2, 3, 6), grey));
  add_mesh(scene, make_quad({-2, 0, 0}, {3.4F, 0, 0}, {0, 3, 0}, grey));
  add_mesh(scene, make_quad({1.4F, 2, 0}, {0.6F, 0, 0}, {0, 1, 0}, grey));
  scene.lights.push_back(PointLight{V3f(-1, 2.5F, -4), Rgb(100, 100, 100)});
  const LitScene world = make_lit_scene(std::move(scene));
  GridBakeParams params;
  params.resolution = V3i(4, 3, 12);
  params.photons = 60'000;
  params.guard = Guard::off;
  constexpr int seeds = 12;
  // E of the last layers of vertices, in the dark room's far end.
  const auto far_end = [&](EmissionMode mode, std::uint64_t first) {
    Accumulator out;
    Accumulator at_one;
    Accumulator stated;
    params.emission = mode;
    for (int seed = 0; seed < seeds; ++seed) {
      params.seed = first + std::uint64_t(seed);
      const IrradianceGrid grid = resolve(bake_grid_sums(world, params));
      double mean = 0;
      for (std::size_t v = 4 * 3 * 9; v < 4 * 3 * 12; ++v) {
        Footprint at;
        at.count = 1;
        at.vertex[0] = std::uint32_t(v);
        at.weight[0] = 1;
        const double e = double(irradiance(grid, at, V3f(0, 1, 0), Reconstruction::optimal).y) +
                         double(irradiance(grid, at, V3f(0, -1, 0), Reconstruction::optimal).y);
        mean += e / 36;
        if (v != 4 * 3 * 10 + 5) continue;
        at_one.add(double(irradiance(grid, at, V3f(0, 1, 0), Reconstruction::optimal).y));
        stated.add(std::pow(double(irradiance_standard_error(grid, at).y), 2));
      }
      out.add(mean);
    }
    return std::tuple(out, at_one, stated.mean());
  };
  const auto guided = far_end(EmissionMode::guided, 1);
  const auto even = far_end(EmissionMode::even, 101);
  // |t| of 22 degrees of freedom.
  EXPECT_LT(std::abs(z_score(std::get<0>(guided), std::get<0>(even))), 5)
      << std::get<0>(guided).mean() << " +- " << std::get<0>(guided).standard_error() << " and "
      << std::get<0>(even).mean() << " +- " << std::get<0>(even).standard_error();
  // A quarter or less for certain; one in a thousand of ratios of variances from 12 seeds each is 8 times off.
  EXPECT_LT(std::get<1>(guided).variance(), 0.7 * std::get<1>(even).variance());
  // Pieces of one photon are not independent, as the grid's own error takes them to be; it holds all the same, to what
  // 12 seeds know of a variance (to a factor of 3 at worst), and up to a half and more too large (irradiance_grid.h).
  const double ratio = std::sqrt(std::get<2>(guided) / std::get<1>(guided).variance());
  EXPECT_GT(ratio, 0.6);
  EXPECT_LT(ratio, 3.5);
}

}  // namespace
}  // namespace ivory
