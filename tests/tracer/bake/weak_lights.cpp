// Photons of a weak light beside a strong one: a room with glowing walls under a sun.
//
// The room is closed, so that only its walls light it: with emission M / pi nits and albedo rho they shine with
// L = M / pi / (1 - rho) everywhere, and every irradiance vector over the hemisphere about an axis is pi L along it. It
// stands on black ground in sunlight, which outside adds E w.
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "grid/field/resolve.h"
#include "tests/support/statistics.h"
#include "tools/stability/scene_builder.h"
#include "tracer/bake/field/baker.h"
#include "tracer/bake/field/deposit/target.h"

namespace ivory {
namespace {

constexpr float sun_lux = 1e5F;
constexpr float albedo = 0.5F;
const V3f sun_direction = V3f(0.3F, -1, 0.2F).normalized();

Scene sun_and_room(bool sun, const Rgb& emission_nits) {
  Scene scene;
  const int black = add_lambert(scene, Rgb(0, 0, 0));
  add_mesh(scene, make_quad({-50, -2, -50}, {0, 0, 100}, {100, 0, 0}, black));  // looks up
  const int wall = add_lambert(scene, Rgb(albedo, albedo, albedo), emission_nits);
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), wall));
  if (sun) scene.lights.push_back(DirectionalLight{sun_direction, Rgb(sun_lux, sun_lux, sun_lux)});
  return scene;
}

GridBakeParams params_at(const V3f& center, float side_m, std::uint64_t photons) {
  GridBakeParams params;
  GridFrame frame;
  frame.size = V3i(2, 2, 2);
  frame.spacing_m = V3f(side_m, side_m, side_m) / 2;
  frame.origin_m = center - frame.spacing_m / 2;
  params.frame = frame;
  params.photons = photons;
  params.guard = Guard::off;
  params.include_direct = true;
  return params;
}

struct Measured {
  // E about +y and, for the noise of a single bake, its own standard error, at the first vertex.
  std::array<Accumulator, 3> up;
  std::array<Accumulator, 3> variance;
};

Measured measure(const LitScene& world, GridBakeParams params, int seeds) {
  Measured m;
  for (int seed = 1; seed <= seeds; ++seed) {
    params.seed = std::uint64_t(seed);
    const IrradianceGrid grid = resolve(bake_grid_sums(world, params));
    const auto vectors = hemispheres_from_moments(std::span<const float, 36>(grid.at(0), 36));
    for (unsigned c = 0; c < 3; ++c) {
      m.up[c].add(double(vectors[9 * 2 + 3 + c]));
      m.variance[c].add(double(grid.variance[0][c]));
    }
  }
  return m;
}

// The sun's power is 8e8 lm, the walls' 75 lm in red and a tenth of that in blue: 1e-7 and 1e-8 of it.
const Rgb dim(1, 0.5F, 0.1F);

TEST(WeakLights, ARoomInAHouseUnderTheSunGetsItsLight) {
  const LitScene world = make_lit_scene(sun_and_room(true, dim));
  EXPECT_EQ(fine_bits(world.lights.photon_power()), 12);
  constexpr std::uint64_t photons = 100'000;
  const Measured inside = measure(world, params_at(V3f(0, 0, 0), 1.2F, photons), 24);
  for (unsigned c = 0; c < 3; ++c) {
    const double truth = double(pi) * double(dim[c]) / (1 - double(albedo));
    EXPECT_LT(std::abs(z_score(inside.up[c], truth)), z_limit)
        << c << ": " << inside.up[c].mean() << " +- " << inside.up[c].standard_error() << ", truth " << truth;
    // 600,000 photons in all are the room's; picked by power alone, that would be none at all.
    EXPECT_LT(inside.up[c].standard_error(), 0.01 * truth) << c;
  }
}

TEST(WeakLights, TheSunIsNoWorseForIt) {
  const LitScene world = make_lit_scene(sun_and_room(true, dim));
  const Measured outside = measure(world, params_at(V3f(-20, 8, 10), 12, 100'000), 24);
  // The vector over the hemisphere about +y is E w. All of the region lies above the room, whose walls therefore do
  // not add to it.
  const double truth = double(sun_lux) * double(-sun_direction.y);
  for (unsigned c = 0; c < 3; ++c) EXPECT_LT(std::abs(z_score(outside.up[c], truth)), z_limit) << c;
}

TEST(WeakLights, BakesOfBothAreTheSumOfBakesOfEach) {
  // Bright enough for the second moments, too, to be counted well: 1e-4 of the sun's power.
  const Rgb bright(1000, 500, 100);
  const LitScene both = make_lit_scene(sun_and_room(true, bright));
  const LitScene sun = make_lit_scene(sun_and_room(true, Rgb(0, 0, 0)));
  const LitScene room = make_lit_scene(sun_and_room(false, bright));
  EXPECT_EQ(fine_bits(both.lights.photon_power()), 12);
  EXPECT_EQ(fine_bits(sun.lights.photon_power()), 0);
  EXPECT_EQ(fine_bits(room.lights.photon_power()), 0);
  struct Place {
    V3f center;
    float side_m;
  };
  for (const Place& place : {Place{V3f(0, 0, 0), 1.2F}, Place{V3f(-20, 8, 10), 12}}) {
    GridBakeParams params = params_at(place.center, place.side_m, 50'000);
    params.emission = EmissionMode::bounds;  // whose shares are known
    const Measured b = measure(both, params, 24);
    const Measured s = measure(sun, params, 24);
    const Measured r = measure(room, params, 24);
    for (unsigned c = 0; c < 3; ++c) {
      const double error = std::sqrt(std::pow(b.up[c].standard_error(), 2) + std::pow(s.up[c].standard_error(), 2) +
                                     std::pow(r.up[c].standard_error(), 2));
      EXPECT_LT(std::abs(b.up[c].mean() - s.up[c].mean() - r.up[c].mean()), z_limit * error + 1e-6 * b.up[c].mean())
          << place.side_m << " " << c;
      EXPECT_GT(b.up[c].mean(), 0);
    }
    if (place.side_m < 2) {
      // The grid's own variance is that of independent bakes' second moments with the room's share of the photons: a
      // quarter, and half of its share of the power, 75,400 lm beside the 909,000 lm that the sun sends at the grid.
      const double share = 0.25 + 0.5 * 75.4 / (75.4 + 909);
      for (unsigned c = 0; c < 2; ++c) EXPECT_NEAR(share * b.variance[c].mean() / r.variance[c].mean(), 1, 0.1) << c;
    }
  }
}

TEST(WeakLights, PartsMergeToTheSameBits) {
  const LitScene world = make_lit_scene(sun_and_room(true, dim));
  GridBakeParams params = params_at(V3f(0, 0, 0), 1.2F, 20'000);
  params.threads = 1;
  const GridAccumulator whole = bake_grid_sums(world, params);
  params.threads = 2;
  std::vector<GridAccumulator> parts;
  for (const auto& range : {std::pair<std::uint64_t, std::uint64_t>{0, 7001}, {7001, 20'000}}) {
    params.photon_range = range;
    parts.push_back(bake_grid_sums(world, params));
  }
  EXPECT_EQ(merge(std::move(parts), {"a", "b"}).sums, whole.sums);
}

}  // namespace
}  // namespace ivory
