// Tables over the turns of an occluder: against tables baked of the turned mesh, and against traced light.
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "grid/base/placement.h"
#include "grid/env/environment_image.h"
#include "grid/env/irradiance.h"
#include "tools/stability/fiv_shapes.h"
#include "tracer/bake/fiv/truth.h"
#include "tracer/bake/fiv/turns.h"

namespace ivory {
namespace {

M44f about_y(double degrees) {
  const M33f turn = turn_about_y(degrees * radians_a_degree);
  M44f m;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) m[row][column] = turn[row][column];
  return m;
}

// A bright patch over a sky that is lighter on one side.
EnvironmentMap patch_sky() {
  EnvironmentMap map;
  map.width = 64;
  map.height = 32;
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column) {
      const bool patch = row >= 6 && row < 10 && column >= 8 && column < 13;
      const float level = patch ? 30.0F : (row < 16 ? 1.0F : 0.3F) * (column < 32 ? 1.5F : 0.7F);
      map.radiance.push_back(Rgb(1, 0.9F, 0.7F) * level);
    }
  }
  return map;
}

FivParams small_params() {
  FivParams params;
  params.samples = {24, 13, 9};
  params.hemispheres = 6;
  params.environment_size = 16;
  params.parts = 256;
  params.silhouette_pixels = 32;
  return params;
}

TEST(FivTurns, FindsTurnedMeshes) {
  const FivOccluder occluder = make_fiv_occluder(bracket_scene());
  FivTable table;
  table.shape = occluder.shape;
  for (const double degrees : {0.0, 1.0, 37.0, 120.0, 180.0, 275.0, 359.0}) {
    M44f place = about_y(degrees);
    place *= M44f().setTranslation(V3f(3, -2, 7));
    const Scene scene = bracket_scene(place);
    const auto found = find_turned_placement(table, scene, std::vector<bool>(3, true));
    ASSERT_TRUE(found) << degrees;
    EXPECT_NEAR(std::remainder(found->turn_rad - degrees * radians_a_degree, 2 * double(pi)), 0, 2e-4) << degrees;
    EXPECT_LT((found->at.center_m - occluder.center_m * place).length(), 1e-3F) << degrees;
    // The same where the turn is in the mesh and no transform tells it.
    Scene flat = scene;
    for (std::size_t i = 0; i < flat.instances.size(); ++i) {
      Mesh mesh = flat.meshes[std::size_t(flat.instances[i].mesh)];
      for (V3f& p : mesh.positions) p = p * flat.instances[i].to_world;
      flat.instances[i] = {int(flat.meshes.size()), M44f(), no_index};
      flat.meshes.push_back(std::move(mesh));
    }
    const auto by_moments = find_turned_placement(table, flat, std::vector<bool>(3, true));
    ASSERT_TRUE(by_moments) << degrees;
    EXPECT_NEAR(std::remainder(by_moments->turn_rad - degrees * radians_a_degree, 2 * double(pi)), 0, 1e-3) << degrees;
  }
  M44f tilted;
  tilted.setEulerAngles(V3f(0.1F, 0.4F, 0));
  EXPECT_FALSE(find_turned_placement(table, bracket_scene(tilted), std::vector<bool>(3, true)));
}

// On a step a set holds what a bake of the turned mesh gives; half a step off, the worst, it is hardly farther from the
// traced truth than a bake of the turned mesh is. Errors of both come from the same receivers.
TEST(FivTurns, AreNearlyAsGoodAsFreshBakes) {
  const EnvironmentMap map = patch_sky();
  const CubeMap cube = cube_from_environment(map, 64);
  const IrradianceTree tree = make_irradiance_tree({EnvironmentLayout::latlong, map});
  const FivOccluder occluder = make_fiv_occluder(bracket_scene());
  constexpr int turns = 24;
  FivParams params = small_params();
  const FivSet set = bake_fiv_turns(occluder, cube, params, turns);
  ASSERT_EQ(set.turns.size(), std::size_t(turns));
  params.radii = set.turns.front().radii;
  EXPECT_TRUE(bake_fiv(turned(occluder, 2 * 3.14159265358979323846 * 6 / turns), cube, params).values ==
              set.turns[6].values);
  double squares = 0;
  double fresh_squares = 0;
  constexpr int angles = 3;
  for (int k = 0; k < angles; ++k) {
    const double turn_rad = 2 * double(pi) * (k * turns / angles + 0.5) / turns;
    const FivOccluder now = turned(occluder, turn_rad);
    const FivTruth truth = trace_fiv_truth(now, map, tree, {300, 256, 5});
    const auto blend = blend_of_turn(turns, turn_rad);
    ASSERT_TRUE(blend);
    FivTable mixed = set.turns[std::size_t(blend->first)];
    const FivTable& next = set.turns[std::size_t(blend->second)];
    for (std::size_t i = 0; i < mixed.values.size(); ++i)
      mixed.values[i] += (next.values[i] - mixed.values[i]) * blend->share;
    const double by_set = fiv_error(mixed, truth).error;
    const double fresh = fiv_error(bake_fiv(now, cube, params), truth).error;
    squares += by_set * by_set;
    fresh_squares += fresh * fresh;
  }
  EXPECT_LT(std::sqrt(squares), 1.5 * std::sqrt(fresh_squares)) << std::sqrt(fresh_squares / angles);
  EXPECT_LT(std::sqrt(fresh_squares / angles), 0.05);
}

}  // namespace
}  // namespace ivory
