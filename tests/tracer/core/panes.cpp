// Surfaces that are partly there: each is met or missed independently of all others, however the scene numbers them.
#include <bit>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"
#include "tools/stability/scene_builder.h"
#include "tracer/core/intersector.h"
#include "tracer/core/rays/filters.h"
#include "tracer/core/sampler.h"

namespace ivory {
namespace {

// Do two triangles' numbers lie on the same side of a half? For independent ones half of the time.
TEST(CoverageThreshold, IsIndependentForAnyTwoTriangles) {
  constexpr std::size_t words = 64;
  std::vector<std::array<std::uint64_t, words>> sides;
  std::vector<std::uint32_t> instances;
  for (std::uint32_t i = 0; i < 64; ++i) instances.push_back(i);
  for (const std::uint32_t i : {93U, 124U, 961U, 1U << 16U, (1U << 31U) - 1}) instances.push_back(i);
  for (const std::uint32_t instance : instances) {
    for (const std::uint32_t triangle : {0U, 1U, 31U, 1U << 20U}) {
      std::array<std::uint64_t, words> bits{};
      for (std::uint32_t seed = 0; seed < 64 * words; ++seed) {
        if (coverage_threshold(seed, triangle_key(instance, triangle)) < 0.5F)
          bits[seed / 64] |= std::uint64_t(1) << (seed % 64);
      }
      sides.push_back(bits);
    }
  }
  constexpr double count = 64 * words;
  double worst = 0;
  for (std::size_t a = 0; a < sides.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      int differ = 0;
      for (std::size_t w = 0; w < words; ++w) differ += std::popcount(sides[a][w] ^ sides[b][w]);
      worst = std::max(worst, std::abs(differ - count / 2) / (std::sqrt(count) / 2));
    }
  }
  // The largest of 37,950 normal scores is above 5.5 once in 700 choices of seeds.
  EXPECT_LT(worst, 5.5);
}

// Six panes one below the other, from z = 0 on, at x = 10 column.
M44f place(int column, int pane) {
  M44f m;
  m.setTranslation(V3f(float(10 * column), 0, float(-pane)));
  return m;
}

// Columns of six panes of alpha 1/2, by how the scene comes to hold them.
Scene panes_of_many_kinds() {
  Scene scene;
  const int glass = add_lambert(scene, Rgb(0.5F), Rgb(0, 0, 0), true);
  scene.materials[std::size_t(glass)].alpha_mode = AlphaMode::blend;
  scene.materials[std::size_t(glass)].alpha = 0.5F;
  const auto pane = [&] { return make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, glass); };

  // Column 0: instances 0, 1 and 2 of one mesh, and meshes placed once that are instances 31, 62 and 93.
  const int shared = add_mesh(scene, pane(), place(0, 0));
  for (const int below : {2, 4}) scene.instances.push_back({shared, place(0, below)});
  for (int below : {1, 3, 5}) {
    while (scene.instances.size() < std::size_t(31 * (below + 1) / 2)) add_mesh(scene, pane(), place(9, 0));
    add_mesh(scene, pane(), place(0, below));
  }
  // Column 1: meshes placed once. Column 2: one mesh placed six times. Column 3: one mesh of all six panes.
  Mesh stack;
  stack.material = glass;
  stack.uvs.emplace_back();
  const int often = add_mesh(scene, pane(), place(2, 0));
  for (int below = 0; below < 6; ++below) {
    add_mesh(scene, pane(), place(1, below));
    if (below > 0) scene.instances.push_back({often, place(2, below)});
    const Mesh one = pane();
    const auto first = std::uint32_t(stack.positions.size());
    for (const V3f& p : one.positions) stack.positions.push_back(p * place(3, below));
    for (const auto& t : one.triangles) stack.triangles.emplace_back(first + t.x, first + t.y, first + t.z);
    stack.uvs[0].insert(stack.uvs[0].end(), one.uvs[0].begin(), one.uvs[0].end());
  }
  add_mesh(scene, std::move(stack));
  // Column 4: one mesh of two panes placed three times.
  Mesh pair;
  pair.material = glass;
  pair.uvs.emplace_back();
  for (const float z : {0.0F, -1.0F}) {
    const Mesh one = make_quad({-1, -1, z}, {2, 0, 0}, {0, 2, 0}, glass);
    const auto first = std::uint32_t(pair.positions.size());
    pair.positions.insert(pair.positions.end(), one.positions.begin(), one.positions.end());
    for (const auto& t : one.triangles) pair.triangles.emplace_back(first + t.x, first + t.y, first + t.z);
    pair.uvs[0].insert(pair.uvs[0].end(), one.uvs[0].begin(), one.uvs[0].end());
  }
  const int pairs = add_mesh(scene, std::move(pair), place(4, 0));
  for (const int below : {2, 4}) scene.instances.push_back({pairs, place(4, below)});
  return scene;
}

// n panes of alpha 1/2 let 0.5^n of all rays pass, and dim each shadow ray to that.
TEST(Panes, StacksPassHalfOfHalf) {
  const Scene scene = panes_of_many_kinds();
  const Intersector intersector(scene);
  RandomStream random(1, StreamPurpose::test, 0);
  for (int column = 0; column < 5; ++column) {
    for (int panes = 1; panes <= 6; ++panes) {
      Ray ray{.origin = V3f(float(10 * column) + 0.3F, 0.2F, 0.5F), .direction = {0, 0, -1}, .t_max = float(panes)};
      Accumulator passed;
      for (int i = 0; i < 8000; ++i) {
        ray.coverage_seed = random.next_u32();
        passed.add(intersector.closest(ray) ? 0 : 1);
      }
      const double truth = std::pow(0.5, panes);
      EXPECT_LT(std::abs(z_score(passed, truth)), z_limit)
          << "column " << column << ", " << panes << " panes: " << passed.mean();
      EXPECT_EQ(intersector.transmittance(ray), float(truth)) << "column " << column;
    }
  }
}

// Where two triangles of a pane meet, a ray meets the pane, and not two.
TEST(Panes, AreMetOnceAlongTheirInnerEdges) {
  const Scene scene = panes_of_many_kinds();
  const Intersector intersector(scene);
  RandomStream random(1, StreamPurpose::test, 1);
  for (int column = 0; column < 5; ++column) {
    for (const float along : {0.0F, 0.25F, -0.5F, 0.3F}) {
      Ray ray{.origin = V3f(float(10 * column) + along, along, 0.5F), .direction = {0, 0, -1}, .t_max = 1};
      EXPECT_EQ(intersector.transmittance(ray), 0.5F) << "column " << column << " at " << along;
      Accumulator passed;
      for (int i = 0; i < 4000; ++i) {
        ray.coverage_seed = random.next_u32();
        passed.add(intersector.closest(ray) ? 0 : 1);
      }
      EXPECT_LT(std::abs(z_score(passed, 0.5)), z_limit) << "column " << column << " at " << along;
    }
  }
}

// Queries that leave nothing to chance: half a surface is there, less than half is not.
TEST(Panes, AreThereOrNotByHalfTheirCoverage) {
  for (const float alpha : {0.49F, 0.5F}) {
    Scene scene;
    const int glass = add_lambert(scene, Rgb(0.5F), Rgb(0, 0, 0), true);
    scene.materials[std::size_t(glass)].alpha_mode = AlphaMode::blend;
    scene.materials[std::size_t(glass)].alpha = alpha;
    for (int i = 0; i < 40; ++i) add_mesh(scene, make_quad({float(2 * i) - 1, -1, 0}, {2, 0, 0}, {0, 2, 0}, glass));
    const Intersector intersector(scene);
    for (int i = 0; i < 40; ++i) {
      const Ray ray{
          .origin = V3f(float(2 * i) + 0.3F, 0.2F, 1), .direction = {0, 0, -1}, .blocking_coverage = half_coverage};
      EXPECT_EQ(intersector.closest(ray).has_value(), alpha >= 0.5F) << i;
    }
  }
}

// All panes up to the wall behind them, nearest first, once each on inner edges, too; what closest() finds is one of
// them or the wall.
TEST(Panes, PassTellsAllInOrder) {
  Scene scene = panes_of_many_kinds();
  const int wall = add_lambert(scene, Rgb(0.5F));
  add_mesh(scene, make_quad({-5, -5, -5.5F}, {200, 0, 0}, {0, 10, 0}, wall));
  for (const bool portable : {false, true}) {
    const Intersector intersector(scene, {portable});
    RandomStream random(1, StreamPurpose::test, 2);
    for (int column = 0; column < 5; ++column) {
      for (const V2f& at : {V2f(0.3F, 0.2F), V2f(0.25F, 0.25F), V2f(0, 0)}) {
        Ray ray{.origin = V3f(float(10 * column) + at.x, at.y, 0.5F), .direction = {0, 0, -1}};
        const Passage passage = intersector.pass(ray);
        ASSERT_EQ(passage.count, 6U) << column << " " << at;
        for (std::size_t i = 0; i < 6; ++i) {
          EXPECT_NEAR(passage.crossed[i].hit.t, float(i) + 0.5F, 1e-5F);
          EXPECT_EQ(passage.crossed[i].coverage, 0.5F);
          EXPECT_NEAR(std::abs(passage.crossed[i].hit.ng.z), 1, 1e-6F);
        }
        ASSERT_TRUE(passage.end);
        EXPECT_NEAR(passage.end->t, 6, 1e-5F);
        ray.coverage_seed = random.next_u32();
        const std::optional<Hit> met = intersector.closest(ray);
        const float before = met->t - 0.5F;
        EXPECT_NEAR(before, before < 5.3F ? std::round(before) : 5.5F, 1e-5F);
        // Ends before the wall, and between panes.
        ray.t_max = 3;
        EXPECT_EQ(intersector.pass(ray).count, 3U);
        EXPECT_FALSE(intersector.pass(ray).end);
      }
    }
  }
}

// Beyond the eighth pane one is met at random: of twelve panes of 1/2, the ninth half of the time, none behind it
// 1/16. The first eight are no longer there for it, wherever the tree finds them.
TEST(Panes, PassMeetsThoseBeyondTheEighthAtRandom) {
  Scene scene;
  const int glass = add_lambert(scene, Rgb(0.5F), Rgb(0, 0, 0), true);
  scene.materials[std::size_t(glass)].alpha_mode = AlphaMode::blend;
  scene.materials[std::size_t(glass)].alpha = 0.5F;
  for (const int pane : {7, 2, 9, 0, 11, 4, 1, 10, 3, 8, 5, 6})
    add_mesh(scene, make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, glass), place(0, pane));
  for (const bool portable : {false, true}) {
    const Intersector intersector(scene, {portable});
    RandomStream random(1, StreamPurpose::test, 3);
    std::vector<Accumulator> met(4);
    Accumulator none;
    for (int i = 0; i < 8000; ++i) {
      const Ray ray{.origin = V3f(0.3F, 0.2F, 0.5F), .direction = {0, 0, -1}, .coverage_seed = random.next_u32()};
      const Passage passage = intersector.pass(ray);
      ASSERT_EQ(passage.count, 8U);
      for (std::size_t k = 0; k < 8; ++k) ASSERT_NEAR(passage.crossed[k].hit.t, float(k) + 0.5F, 1e-5F);
      for (std::size_t k = 0; k < 4; ++k)
        met[k].add(passage.end && std::abs(passage.end->t - float(k) - 8.5F) < 0.1F ? 1 : 0);
      none.add(passage.end ? 0 : 1);
    }
    for (std::size_t k = 0; k < 4; ++k) EXPECT_LT(std::abs(z_score(met[k], std::pow(0.5, double(k) + 1))), z_limit);
    EXPECT_LT(std::abs(z_score(none, 1.0 / 16)), z_limit);
  }
}

// Back faces that the eye does not see are not crossed either.
TEST(Panes, PassLeavesOutCulledBackFaces) {
  Scene scene;
  const int glass = add_lambert(scene, Rgb(0.5F));
  scene.materials[std::size_t(glass)].alpha_mode = AlphaMode::blend;
  scene.materials[std::size_t(glass)].alpha = 0.5F;
  add_mesh(scene, make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, glass));   // looks to +z
  add_mesh(scene, make_quad({-1, -1, -1}, {0, 2, 0}, {2, 0, 0}, glass));  // looks to -z
  const Intersector intersector(scene);
  Ray ray{.origin = {0.3F, 0.2F, 1}, .direction = {0, 0, -1}};
  EXPECT_EQ(intersector.pass(ray).count, 2U);
  ray.cull_back_faces = true;
  const Passage passage = intersector.pass(ray);
  ASSERT_EQ(passage.count, 1U);
  EXPECT_NEAR(passage.crossed[0].hit.t, 1, 1e-5F);
}

}  // namespace
}  // namespace ivory
