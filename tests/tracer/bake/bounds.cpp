// Grids over a small part of a large scene: photons of suns and skies must be sent there.
//
// The light in a room does not depend on how far black ground reaches around the plot it stands on, as long as the sky
// is black below the horizon: a room on 12 m of ground, whose bounds are as large as the scene and so get their photons
// through the one disc over all of it, is the truth for the same room on 1 km and on 100 km.
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "grid/field/evidence.h"
#include "grid/field/resolve.h"
#include "tests/support/statistics.h"
#include "tools/stability/scene_builder.h"
#include "tracer/bake/field/baker.h"
#include "tracer/render/photons/map.h"

namespace ivory {
namespace {

const V3f sun_direction = V3f(-0.3F, -0.8F, -0.6F).normalized();
constexpr float sun_lux = 1e4F;

// Open towards +z and, by a hole in its roof, upwards; on ground of 12 m, and black ground around that.
Scene room_on_ground(float half_side_m, bool sun, bool sky, const M44f& to_world = M44f()) {
  Scene scene;
  const int wall = add_lambert(scene, Rgb(0.6F, 0.5F, 0.4F), Rgb(0, 0, 0), true);
  const int ground = add_lambert(scene, Rgb(0.4F, 0.4F, 0.3F));
  const int black = add_lambert(scene, Rgb(0, 0, 0));
  add_mesh(scene, make_quad({-3, 0, -3}, {6, 0, 0}, {0, 3, 0}, wall), to_world);
  add_mesh(scene, make_quad({-3, 0, -3}, {0, 3, 0}, {0, 0, 6}, wall), to_world);
  add_mesh(scene, make_quad({3, 0, -3}, {0, 0, 6}, {0, 3, 0}, wall), to_world);
  add_mesh(scene, make_quad({-3, 3, -3}, {0, 0, 4}, {6, 0, 0}, wall), to_world);
  add_mesh(scene, make_quad({-6, 0, -6}, {0, 0, 12}, {12, 0, 0}, ground), to_world);  // looks up
  if (half_side_m > 6) {
    const float d = -0.1F;
    add_mesh(scene, make_quad({-half_side_m, d, -half_side_m}, {0, 0, 2 * half_side_m}, {2 * half_side_m, 0, 0}, black),
             to_world);
  }
  V3f direction;
  to_world.multDirMatrix(sun_direction, direction);
  if (sun) scene.lights.push_back(DirectionalLight{direction, Rgb(sun_lux, sun_lux, sun_lux)});
  if (sky) {
    scene.environment = uniform_environment(Rgb(500, 700, 1000));
    for (std::size_t i = scene.environment->radiance.size() / 2; i < scene.environment->radiance.size(); ++i)
      scene.environment->radiance[i] = Rgb(0, 0, 0);
  }
  return scene;
}

Footprint vertex(std::size_t v) {
  Footprint at;
  at.count = 1;
  at.vertex[0] = std::uint32_t(v);
  at.weight[0] = 1;
  return at;
}

GridBakeParams room_params(std::uint64_t photons) {
  GridBakeParams params;
  params.bounds = Box3f(V3f(-3, 0, -3), V3f(3, 3, 3));
  params.resolution = V3i(2, 2, 2);
  params.photons = photons;
  params.guard = Guard::off;
  return params;
}

constexpr int seeds = 8;
const std::array<V3f, 3> normals{V3f(0, 1, 0), V3f(0, -1, 0), V3f(0, 0, 1)};

// Means over vertices of E for each of the normals, over seeds.
std::array<Accumulator, 3> mean_e(const LitScene& world, GridBakeParams params) {
  std::array<Accumulator, 3> out;
  for (int seed = 1; seed <= seeds; ++seed) {
    params.seed = std::uint64_t(seed) + 100;
    const IrradianceGrid grid = resolve(bake_grid_sums(world, params));
    for (std::size_t i = 0; i < normals.size(); ++i) {
      double mean = 0;
      for (std::size_t v = 0; v < grid.frame.vertex_count(); ++v)
        mean += double(irradiance(grid, vertex(v), normals[i], Reconstruction::optimal).y);
      out[i].add(mean / double(grid.frame.vertex_count()));
    }
  }
  return out;
}

TEST(Bounds, ARoomIsAsLightOnWideGroundAsOnAPlot) {
  for (const bool sun : {true, false}) {
    const GridBakeParams params = room_params(25'000);
    const auto plot = mean_e(make_lit_scene(room_on_ground(6, sun, !sun)), params);
    for (const float half_side_m : {500.0F, 50'000.0F}) {
      const auto wide = mean_e(make_lit_scene(room_on_ground(half_side_m, sun, !sun)), params);
      for (std::size_t i = 0; i < normals.size(); ++i) {
        EXPECT_LT(std::abs(z_score(wide[i], plot[i])), z_limit)
            << sun << " " << half_side_m << " " << normals[i] << ": " << wide[i].mean() << " and " << plot[i].mean();
        // Through the scene's disc alone, one photon in 20,000 or none would come.
        EXPECT_LT(wide[i].standard_error(), 0.1 * wide[i].mean()) << sun << " " << half_side_m << " " << normals[i];
      }
    }
  }
}

TEST(Bounds, MayBeTurned) {
  M44f turn;
  turn.rotate(V3f(0, 30 * pi / 180, 0));
  GridBakeParams params = room_params(25'000);
  const Accumulator plot = mean_e(make_lit_scene(room_on_ground(6, true, false)), params)[0];
  params.rotate_y_deg = 30;
  const Accumulator wide = mean_e(make_lit_scene(room_on_ground(500, true, false, turn)), params)[0];
  EXPECT_LT(std::abs(z_score(wide, plot)), z_limit) << wide.mean() << " and " << plot.mean();
}

TEST(Bounds, GroundFarAroundLightsThem) {
  for (const float half_side_m : {500.0F, 50'000.0F}) {
    Scene scene;
    const int ground = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
    add_mesh(scene,
             make_quad({-half_side_m, 0, -half_side_m}, {0, 0, 2 * half_side_m}, {2 * half_side_m, 0, 0}, ground));
    scene.lights.push_back(DirectionalLight{V3f(0, -1, 0), Rgb(sun_lux, sun_lux, sun_lux)});
    GridBakeParams params = room_params(25'000);
    params.bounds = Box3f(V3f(99, 4, 99), V3f(101, 6, 101));
    const Accumulator down = mean_e(make_lit_scene(std::move(scene)), params)[1];
    EXPECT_LT(std::abs(z_score(down, 0.5 * double(sun_lux))), z_limit) << half_side_m << ": " << down.mean();
  }
}

// Light straight from sun and sky, and a lamp beside them: in the middle of wide ground, and past all surfaces.
TEST(Bounds, GetDirectLightWhereverTheyLie) {
  for (const V3f& center : {V3f(0, 5, 0), V3f(0, 90'000, 0)}) {
    for (const bool lamp : {false, true}) {
      Scene scene;
      const int black = add_lambert(scene, Rgb(0, 0, 0));
      add_mesh(scene, make_quad({-50'000, 0, -50'000}, {0, 0, 100'000}, {100'000, 0, 0}, black));
      scene.lights.push_back(DirectionalLight{sun_direction, Rgb(sun_lux, sun_lux, sun_lux)});
      scene.environment = uniform_environment(Rgb(100, 100, 100));
      double truth = double(sun_lux) * double(-sun_direction.y) + double(pi) * 100;
      if (lamp) {
        // 20 m above a cell of 1 m: E over it varies by a thousandth about I / r^2.
        scene.lights.push_back(PointLight{center + V3f(0, 20, 0), Rgb(4e5F, 4e5F, 4e5F)});
        truth += 1000;
      }
      GridBakeParams params = room_params(20'000);
      params.bounds = Box3f(center - V3f(0.5F, 0.5F, 0.5F), center + V3f(0.5F, 0.5F, 0.5F));
      params.include_direct = true;
      const LitScene world = make_lit_scene(std::move(scene));
      Accumulator up;
      for (int seed = 1; seed <= seeds; ++seed) {
        params.seed = std::uint64_t(seed);
        const IrradianceGrid grid = resolve(bake_grid_sums(world, params));
        // The hemispherical vector about +y: no reconstruction's error.
        double mean = 0;
        for (std::size_t v = 0; v < 8; ++v) {
          const auto vectors = hemispheres_from_moments(std::span<const float, 36>(grid.at(v), 36));
          mean += double(vectors[9 * 2 + 3 + 1]) / 8;
        }
        up.add(mean);
      }
      EXPECT_LT(std::abs(up.mean() - truth), z_limit * up.standard_error() + 2e-3 * truth)
          << center << " " << lamp << ": " << up.mean() << ", truth " << truth;
      EXPECT_LT(up.standard_error(), 0.03 * truth) << center << " " << lamp;
    }
  }
}

TEST(Bounds, PartsMergeToTheSameBits) {
  const LitScene world = make_lit_scene(room_on_ground(50'000, true, true));
  GridBakeParams params = room_params(20'000);
  const GridAccumulator whole = bake_grid_sums(world, params);
  std::vector<GridAccumulator> parts;
  for (const auto& range : {std::pair<std::uint64_t, std::uint64_t>{0, 7001}, {7001, 20'000}}) {
    params.photon_range = range;
    parts.push_back(bake_grid_sums(world, params));
  }
  const GridAccumulator merged = merge(std::move(parts), {"a", "b"});
  EXPECT_EQ(merged.sums, whole.sums);
  EXPECT_EQ(merged.counters, whole.counters);
  // emitted == absorbed + escaped + terminated, to the unit.
  const auto& c = whole.counters;
  EXPECT_EQ(c.at("ledger_emitted"), c.at("ledger_absorbed") + c.at("ledger_escaped") + c.at("ledger_terminated"));
}

// The grid's own standard error is that of its photons: over seeds, and where none came.
TEST(Bounds, StandardErrorsHoldOnWideGround) {
  const LitScene world = make_lit_scene(room_on_ground(500, true, true));
  GridBakeParams params = room_params(20'000);
  Accumulator e;
  Accumulator variance;
  const Footprint at = vertex(0);
  for (int seed = 1; seed <= 24; ++seed) {
    params.seed = std::uint64_t(seed);
    const IrradianceGrid grid = resolve(bake_grid_sums(world, params));
    e.add(double(irradiance(grid, at, V3f(0, 1, 0), Reconstruction::optimal).y));
    variance.add(std::pow(double(irradiance_standard_error(grid, at).y), 2));
  }
  // 24 seeds know their spread to a seventh; the estimate is up to a half too large (irradiance_grid.h).
  const double ratio = std::sqrt(variance.mean() / e.variance());
  EXPECT_GT(ratio, 0.8);
  EXPECT_LT(ratio, 2.2);
}

// The photon map has no bounds: it is sent where the picture looks.
TEST(Bounds, OfAPictureAreWhatItShows) {
  Camera camera;
  camera.to_world.setTranslation(V3f(0, 1.5F, 5));  // into the room
  const View view = make_view("test", camera, 64, 48);
  const LitScene plot = make_lit_scene(room_on_ground(6, true, false));
  const LitScene wide = make_lit_scene(room_on_ground(50'000, true, false));
  const std::optional<EmissionTarget> target = target_in_view(wide.intersector, view);
  ASSERT_TRUE(target);
  EXPECT_GT(target->radius_m, 2);
  EXPECT_LT(target->radius_m, 10);
  EXPECT_LT((target->center - V3f(0, 1.5F, 0)).length(), 4);
  const auto ceiling = [](const LitScene& world, const std::optional<EmissionTarget>& of) {
    PhotonMapParams params;
    params.photons = 60'000;
    params.seed = 3;
    params.target = of;
    const PhotonMap map(world, params);
    double e = 0;
    for (int i = 0; i < 16; ++i)
      e += double(map.irradiance(V3f(float(i % 4) - 1.5F, 3, float(i / 4) - 2.5F), V3f(0, -1, 0)).y) / 16;
    return e;
  };
  const double truth = ceiling(plot, std::nullopt);
  EXPECT_GT(truth, 100);
  // Some thousand photons came to the ceiling, of 16 times the power where they come by way of the yard.
  EXPECT_NEAR(ceiling(wide, target), truth, 0.12 * truth);
  EXPECT_EQ(ceiling(wide, std::nullopt), 0);
}

// Sunlight from above, so few photons that two or three are expected in a cell: some cells are met by none, and there
// the bound, three photons, is above the truth.
TEST(Evidence, WhereNoPhotonCameEIsBounded) {
  Scene scene;
  const int black = add_lambert(scene, Rgb(0, 0, 0));
  add_mesh(scene, make_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, black));
  scene.lights.push_back(DirectionalLight{V3f(0, -1, 0), Rgb(100, 100, 100)});
  const LitScene world = make_lit_scene(std::move(scene));
  GridBakeParams params;
  params.bounds = Box3f(V3f(-1, 0, -1), V3f(1, 2, 1));
  params.resolution = V3i(8, 8, 8);
  params.photons = 250;
  params.guard = Guard::off;
  params.include_direct = true;
  const GridAccumulator sums = bake_grid_sums(world, params);
  IrradianceGrid grid = resolve(sums);
  for (const auto& [key, value] : sums.counters) grid.metadata[key] = value;  // as a file has them
  const std::optional<float> bound = unmet_bound_lux(grid);
  ASSERT_TRUE(bound);
  std::size_t unmet = 0;
  for (std::size_t v = 0; v < 512; ++v) {
    const Footprint at = vertex(v);
    if (!is_black(irradiance_standard_error(grid, at))) continue;
    ++unmet;
    EXPECT_EQ(irradiance_standard_error(grid, at, *bound), Rgb(*bound, *bound, *bound));
  }
  const Evidence found = evidence(sums);
  EXPECT_EQ(found.vertices, 512);
  EXPECT_EQ(found.unmet, unmet);
  EXPECT_GT(unmet, 8);
  EXPECT_LT(unmet, 256);
  EXPECT_GT(found.few, 100);
  // A photon in the mean is E over the expected number.
  const double expected = *bound > 0 ? 3 * 100 / double(*bound) : 0;
  EXPECT_GT(expected, 1);
  EXPECT_LT(expected, 4);
  EXPECT_NEAR(double(unmet) / 512, std::exp(-expected), 0.12);
  EXPECT_NEAR(found.median, std::max(1.0, expected), 1.1);
}

TEST(Evidence, CountsPhotonsInEveryBasis) {
  Scene scene;
  const int glowing = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F), Rgb(1, 1, 1));
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), glowing));
  const LitScene world = make_lit_scene(std::move(scene));
  GridBakeParams params;
  params.resolution = V3i(4, 4, 4);
  params.photons = 20'000;
  params.guard = Guard::off;
  params.include_direct = true;
  std::vector<double> medians;
  for (const Basis basis : {Basis::vectors, Basis::vectors9, Basis::ambient_cube, Basis::sh9, Basis::sh4}) {
    params.basis = basis;
    const Evidence found = evidence(bake_grid_sums(world, params));
    EXPECT_EQ(found.unmet + found.few, 0);
    medians.push_back(found.median);
  }
  // Paths of albedo a half have two segments in the mean, of 4/3 m, whose places are sampled about every 0.65 m, in one
  // of 64 cells: 1280. Read from vectors it comes out up to a quarter too low.
  for (const double median : medians) EXPECT_NEAR(median, 1200, 300);
  params.photons = 200'000;
  EXPECT_NEAR(evidence(bake_grid_sums(world, params)).median / medians.back(), 10, 0.5);
}

}  // namespace
}  // namespace ivory
