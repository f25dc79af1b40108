// Bakes that keep groups of lights apart: what groups are made of, that they add up to the bytes of the whole, and that
// each is what its lights alone give.
#include "tracer/lights/groups.h"

#include <cmath>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/field/mix.h"
#include "grid/field/resolve.h"
#include "tests/support/statistics.h"
#include "tools/stability/scene_builder.h"
#include "tracer/bake/field/baker.h"

namespace ivory {
namespace {

// Two lamps and a panel, each under a node of its own; `lit` says which of them shine.
Scene room_with_nodes(const std::array<bool, 4>& lit = {true, true, true, true}) {
  Scene scene;
  const int white = add_lambert(scene, Rgb(0.7F, 0.6F, 0.5F));
  const int panel = add_lambert(scene, Rgb(0, 0, 0), lit[2] ? Rgb(30, 40, 50) : Rgb(0, 0, 0));
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), white));
  add_mesh(scene, make_quad({-0.3F, 0.98F, -0.3F}, {0.6F, 0, 0}, {0, 0, 0.6F}, panel));
  scene.instances[0].node = 0;
  scene.instances[1].node = 5;
  scene.nodes = {{"House", no_index, "", ""},  {"Hall", 0, "", ""}, {"Lamp.001", 1, "", ""},
                 {"Lamp.002", 0, "", "night"}, {"Sun", 0, "", ""},  {"Panel", 0, "", ""}};
  const auto add = [&](const PunctualLight& light, int node) {
    scene.lights.push_back(light);
    scene.light_nodes.push_back(node);
  };
  if (lit[0]) add(PointLight{V3f(-0.5F, 0.5F, 0.5F), Rgb(5, 4, 3)}, 2);
  if (lit[1]) add(PointLight{V3f(0.6F, -0.5F, 0.1F), Rgb(0.01F, 0.02F, 0.03F)}, 3);
  if (lit[3]) add(DirectionalLight{V3f(0, -1, 0), Rgb(9, 9, 9)}, 4);  // shut out
  return scene;
}

std::vector<std::string> groups_of(const std::vector<LightGroupRule>& rules) {
  const LitScene lit = make_lit_scene(room_with_nodes());
  const LightGroups groups = make_light_groups(lit.lights, *lit.scene, rules);
  std::vector<std::string> of_light;
  for (const int group : groups.of_light) of_light.push_back(groups.names.at(std::size_t(group)));
  return of_light;
}

// Lights: Lamp.001, Lamp.002, Sun, and the panel's two triangles.
TEST(LightGroups, GoByNamesOfNodesAboveThenByExtras) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(groups_of({}), (Names{"rest", "night", "rest", "rest", "rest"}));
  EXPECT_EQ(groups_of({{"lamps", {"Lamp.*"}}, {"sun", {"@suns"}}}), (Names{"lamps", "lamps", "sun", "rest", "rest"}));
  EXPECT_EQ(groups_of({{"a", {"Hall"}}, {"b", {"Pane?", "House"}}}), (Names{"a", "b", "b", "b", "b"}));
  EXPECT_EQ(groups_of({{"a", {"Hall"}}, {"a", {"Sun"}}}), (Names{"a", "night", "a", "rest", "rest"}));
  const std::vector<std::vector<LightGroupRule>> refused = {{{"a", {"lamp*"}}},
                                                            {{"a", {"@environment"}}},
                                                            {{"a", {"*"}}, {"b", {"Sun"}}},
                                                            {{"a b", {"*"}}},
                                                            {{std::string(65, 'a'), {"*"}}}};
  for (const auto& rules : refused) EXPECT_THROW(groups_of(rules), ParameterError) << rules.back().name;
}

GridBakeParams small_bake(EmissionMode emission) {
  GridBakeParams params;
  params.resolution = V3i(4, 4, 4);
  params.photons = 60'000;
  params.emission = emission;
  return params;
}

GridAccumulator bake(const Scene& scene, GridBakeParams params, bool grouped) {
  const LitScene lit = make_lit_scene(scene);
  if (grouped) params.groups = make_light_groups(lit.lights, *lit.scene, {{"hall", {"Hall"}}, {"sun", {"@suns"}}});
  return bake_grid_sums(lit, params);
}

TEST(LightGroups, AddUpToTheBytesOfTheWhole) {
  for (const EmissionMode emission : {EmissionMode::guided, EmissionMode::even}) {
    for (const int levels : {1, 2}) {
      GridBakeParams params = small_bake(emission);
      params.levels = levels;
      if (levels == 2) params.resolution = V3i(16, 16, 16);
      const GridAccumulator whole = bake(room_with_nodes(), params, false);
      params.threads = 3;
      GridAccumulator grouped = bake(room_with_nodes(), params, true);
      EXPECT_EQ(grouped.sums, whole.sums);
      ASSERT_EQ(grouped.groups.size(), 4U);  // hall, sun, night, rest
      std::vector<std::int64_t> sums(whole.sums.size(), 0);
      for (const SumGroup& group : grouped.groups) {
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += group.sums[i];
      }
      EXPECT_EQ(sums, whole.sums);
      // In parts, too.
      std::vector<GridAccumulator> parts;
      for (const std::uint64_t begin : {0, 30'000}) {
        params.photon_range = {{begin, begin + 30'000}};
        parts.push_back(bake(room_with_nodes(), params, true));
      }
      const GridAccumulator merged = merge(std::move(parts), {"a", "b"});
      ASSERT_EQ(merged.groups.size(), grouped.groups.size());
      for (std::size_t g = 0; g < merged.groups.size(); ++g) {
        EXPECT_EQ(merged.groups[g].name, grouped.groups[g].name);
        EXPECT_EQ(merged.groups[g].sums, grouped.groups[g].sums);
      }
    }
  }
}

// A group's mean E over the grid, over seeds, is that of bakes in which its lights alone shine.
TEST(LightGroups, AreWhatTheirLightsAloneGive) {
  const auto mean_e = [](const IrradianceGrid& grid, const StoredMoments& stored) {
    IrradianceGrid one = grid;
    static_cast<StoredMoments&>(one) = stored;
    double e = 0;
    for (std::size_t v = 0; v < grid.vertex_count(); ++v) {
      Footprint at;
      at.count = 1;
      at.vertex[0] = std::uint32_t(v);
      at.weight[0] = 1;
      e += double(irradiance(one, at, V3f(0, 1, 0), Reconstruction::optimal).y) / double(grid.vertex_count());
    }
    return e;
  };
  const std::vector<std::array<bool, 4>> lit = {{true, false, false, false},
                                                {false, false, false, true},
                                                {false, true, false, false},
                                                {false, false, true, false}};
  std::array<Accumulator, 4> together;
  std::array<Accumulator, 4> alone;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    GridBakeParams params = small_bake(EmissionMode::guided);
    params.seed = seed;
    const IrradianceGrid grid = resolve_groups(bake(room_with_nodes(), params, true));
    params.seed = seed + 100;
    for (std::size_t g = 0; g < 4; ++g) {
      together[g].add(mean_e(grid, grid.groups[g]));
      const IrradianceGrid other = resolve(bake(room_with_nodes(lit[g]), params, false));
      alone[g].add(mean_e(other, other));
    }
  }
  for (std::size_t g = 0; g < 4; ++g) {
    EXPECT_LT(std::abs(z_score(together[g], alone[g])), z_limit)
        << g << ": " << together[g].mean() << " and " << alone[g].mean();
    if (g == 1) {
      EXPECT_EQ(together[g].mean(), 0);  // the sun is shut out
    } else {
      EXPECT_LT(together[g].standard_error(), 0.05 * together[g].mean()) << g << ": nothing is told apart";
    }
  }
}

TEST(LightGroups, AreMixedByFactors) {
  IrradianceGrid grid = resolve_groups(bake(room_with_nodes(), small_bake(EmissionMode::guided), true));
  grid.metadata["certificate_error"] = 0.01;
  const IrradianceGrid same = mix_groups(grid, {{"hall", Rgb(1, 1, 1)}});
  EXPECT_EQ(same.moments, grid.moments);
  EXPECT_EQ(same.variance, grid.variance);
  EXPECT_TRUE(same.groups.empty());
  EXPECT_FALSE(same.metadata.contains(lamp_groups_key));
  EXPECT_TRUE(same.metadata.contains("certificate_error"));

  const Rgb tint(0.5F, 2, 0);
  const IrradianceGrid mixed = mix_groups(grid, {{"hall", tint}, {"rest", Rgb(0, 0, 0)}});
  EXPECT_FALSE(mixed.metadata.contains("certificate_error"));  // it was measured of the sum of all
  const auto stride = std::size_t(grid.stride());
  for (std::size_t i = 0; i < grid.moments.size(); ++i) {
    float scale = 1e-3F;
    for (const GridGroup& group : grid.groups) scale += 2 * std::abs(group.moments[i]);
    EXPECT_NEAR(
        mixed.moments[i],
        tint[unsigned(i % 3)] * grid.groups[0].moments[i] + grid.groups[1].moments[i] + grid.groups[2].moments[i],
        1e-6F * scale);  // roundings of four terms, which may cancel
    EXPECT_NEAR(
        grid.groups[0].moments[i] + grid.groups[1].moments[i] + grid.groups[2].moments[i] + grid.groups[3].moments[i],
        grid.moments[i], 1e-6F * scale);
  }
  EXPECT_EQ(stride, 36U);
  EXPECT_NEAR(mixed.variance[5].y,
              4 * grid.groups[0].variance[5].y + grid.groups[1].variance[5].y + grid.groups[2].variance[5].y,
              1e-5F * mixed.variance[5].y);
  for (const float factor : {-1.0F, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()})
    EXPECT_THROW(mix_groups(grid, {{"hall", Rgb(1, factor, 1)}}), ParameterError) << factor;
  EXPECT_THROW(mix_groups(grid, {{"halls", Rgb(1, 1, 1)}}), ParameterError);
  EXPECT_THROW(mix_groups(same, {}), ParameterError);
}

// The photons are the same, whichever kinds of sources leave their direct light too: it adds up to the last unit.
TEST(DirectSources, KindsAddUpToAll) {
  Scene scene = room_with_nodes();
  EnvironmentMap map;
  map.width = 2;
  map.height = 1;
  map.radiance = {Rgb(3, 2, 1), Rgb(1, 1, 1)};
  scene.environment = map;
  scene.meshes[0].triangles.resize(8);  // open to the sky
  const LitScene lit = make_lit_scene(std::move(scene));
  GridBakeParams params;
  params.resolution = V3i(4, 4, 4);
  params.photons = 50'000;
  params.emission = EmissionMode::even;
  const auto sums_of = [&](const DirectSources& direct) {
    params.include_direct = direct;
    GridAccumulator sums = bake_grid_sums(lit, params);
    EXPECT_EQ(sums.light, stored_light(direct));
    EXPECT_EQ(direct_sources(sums.light), direct);
    return sums.sums;
  };
  const std::vector<std::int64_t> indirect = sums_of(false);
  std::vector<std::int64_t> added = indirect;
  for (bool DirectSources::*kind : {&DirectSources::punctual, &DirectSources::area, &DirectSources::sky}) {
    DirectSources direct;
    direct.*kind = true;
    const std::vector<std::int64_t> with = sums_of(direct);
    EXPECT_NE(with, indirect);
    for (std::size_t i = 0; i < added.size(); ++i) added[i] += with[i] - indirect[i];
  }
  EXPECT_TRUE(added == sums_of(true));
}

}  // namespace
}  // namespace ivory
