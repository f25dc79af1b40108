// Bakes on several spacings: where bricks go, and that each level is what a uniform grid of its spacing would be.
#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/field/resolve.h"
#include "tests/support/random_lattice.h"
#include "tools/stability/fiv_shapes.h"
#include "tools/stability/scene_builder.h"
#include "tracer/bake/field/baker.h"
#include "tracer/bake/field/scene_lattice.h"
#include "tracer/core/sampler.h"
#include "tracer/render/guard_rays.h"

namespace ivory {
namespace {

// Against points all over the triangles: every brick that one of them comes within reach of is there, and none that no
// point comes near.
TEST(SceneLattice, BricksAreThoseNearSurfaces) {
  Scene scene;
  const int white = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(-1, 1);
  const auto anywhere = [&](float scale) { return V3f(uniform(random), uniform(random), uniform(random)) * scale; };
  std::vector<V3f> points;
  for (int i = 0; i < 12; ++i) {
    const V3f corner = anywhere(6);
    const V3f a = anywhere(i < 4 ? 8.0F : 0.3F);
    const V3f b = anywhere(i % 3 == 0 ? 4.0F : 0.5F);
    add_mesh(scene, make_quad(corner, a, b, white));
    const auto steps = int(std::max(a.length(), b.length()) / 0.04F) + 2;
    for (int j = 0; j <= steps; ++j) {
      for (int k = 0; k <= steps; ++k)
        points.push_back(corner + a * (float(j) / float(steps)) + b * (float(k) / float(steps)));
    }
  }
  GridFrame frame = coarsest_frame(V3i(32, 24, 40), true);
  frame.spacing_m = V3f(0.25F, 0.3F, 0.2F);
  frame.origin_m = frame.direction_to_world(V3f(-4, -3.5F, -4));
  constexpr float reach = 1.5F;
  const auto reached = [&](float voxels) {
    std::set<std::array<int, 3>> bricks;
    for (const V3f& p : points) {
      const V3f index = frame.to_index(p) + V3f(0.5F, 0.5F, 0.5F);
      V3i first;
      V3i last;
      for (int axis = 0; axis < 3; ++axis) {
        first[axis] = std::max(0, int(std::floor((index[axis] - voxels) / 4)));
        last[axis] = std::min(frame.size[axis] / 4 - 1, int(std::floor((index[axis] + voxels) / 4)));
      }
      for (int z = first.z; z <= last.z; ++z) {
        for (int y = first.y; y <= last.y; ++y) {
          for (int x = first.x; x <= last.x; ++x) bricks.insert({x, y, z});
        }
      }
    }
    return bricks;
  };
  std::set<std::array<int, 3>> found;
  for (const V3i& b : bricks_near_surfaces(scene, frame, reach)) found.insert({b.x, b.y, b.z});
  const auto least = reached(reach - 1e-3F);
  // No triangle's point is farther than 0.04 m, 0.2 voxels, from one of these along an axis.
  const auto most = reached(reach + 0.25F);
  EXPECT_GT(least.size(), 50U);
  EXPECT_LT(most.size(), std::size_t(8 * 6 * 10));
  EXPECT_TRUE(std::includes(found.begin(), found.end(), least.begin(), least.end()));
  EXPECT_TRUE(std::includes(most.begin(), most.end(), found.begin(), found.end()));
}

GridBakeParams small_bake(int levels) {
  GridBakeParams params;
  params.voxel_size_m = 0.125F;
  params.levels = levels;
  params.photons = 60'000;
  params.threads = 2;
  params.include_direct = true;
  return params;
}

TEST(LatticeBake, TilesTheSceneAndIsFineAtItsSurfaces) {
  const Scene scene = small_room();
  const GridBakeParams params = small_bake(3);
  const Lattice lattice = default_lattice(scene, params);
  ASSERT_EQ(lattice.levels(), 3);
  EXPECT_EQ(lattice.finest_frame().spacing_m, V3f(0.125F, 0.125F, 0.125F));
  const Box3f box = bounds(scene);
  for (int level = 0; level < 3; ++level) {
    const GridFrame& frame = lattice.frame_of(level);
    const V3f low = frame.to_world(V3f(-0.5F, -0.5F, -0.5F));
    const V3f high = frame.to_world(V3f(frame.size) - V3f(0.5F, 0.5F, 0.5F));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(low[axis], box.min[axis] + 1e-5F);
      EXPECT_GE(high[axis], box.max[axis] - 1e-5F);
      EXPECT_EQ(frame.size[axis] % (2 << level), 0);
    }
  }
  // Trilinear look-ups on surfaces read the finest level alone.
  RandomStream random(1, StreamPurpose::test, 0);
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    for (const auto& t : mesh.triangles) {
      const V3f a = mesh.positions[t.x] * instance.to_world;
      const V3f b = mesh.positions[t.y] * instance.to_world;
      const V3f c = mesh.positions[t.z] * instance.to_world;
      const V3f n = (b - a).cross(c - a).normalized();
      for (int i = 0; i < 20; ++i) {
        const float u = random.next();
        const float v = random.next() * (1 - u);
        const Footprint f = make_footprint(
            lattice, {.p = a + (b - a) * u + (c - a) * v, .ng = n, .nudge_voxels = 0.25F}, Interpolation::trilinear);
        for (int e = 0; e < f.count; ++e) EXPECT_EQ(lattice.level_of(f.vertex[std::size_t(e)]), 2);
      }
    }
  }
  GridBakeParams moving = params;
  moving.dynamic_regions = {Box3f(V3f(-0.2F, -0.2F, -0.2F), V3f(0.2F, 0.2F, 0.2F))};
  const Lattice with_box = default_lattice(scene, moving);
  const Footprint f = make_footprint(with_box, {.p = V3f(0.1F, 0, 0.1F)}, Interpolation::trilinear);
  for (int e = 0; e < f.count; ++e) EXPECT_EQ(with_box.level_of(f.vertex[std::size_t(e)]), 2);
}

// Sums, what vertices see and their planes, to the bit.
TEST(LatticeBake, RefinedEverywhereItsFinestLevelIsAUniformBake) {
  const LitScene lit = make_lit_scene(small_room());
  GridBakeParams params;
  params.photons = 30'000;
  params.threads = 1;
  params.resolution = V3i(4, 4, 4);
  GridFrame coarsest = default_frame(*lit.scene, params);
  coarsest.local_to_world = coarsest_frame(V3i(4, 4, 4), true).local_to_world;
  params.lattice = whole_lattice(coarsest, 2);
  const GridAccumulator refined = bake_grid_sums(lit, params);
  params.lattice = refined.finest_frame();
  const GridAccumulator uniform = bake_grid_sums(lit, params);
  const GridFrame& frame = uniform.frame;
  for (std::uint32_t v = refined.finer[0].first_vertex; v < refined.vertex_count(); ++v) {
    const V3i at = refined.place_of(v).at;
    const std::size_t there = frame.vertex_index(at.x, at.y, at.z);
    ASSERT_EQ(refined.visible_fraction[v], uniform.visible_fraction[there]);
    for (std::size_t i = 0; i < 96; ++i) ASSERT_EQ(refined.sums[v * 96 + i], uniform.sums[there * 96 + i]);
  }
  const IrradianceGrid a = resolve(refined);
  const IrradianceGrid b = resolve(uniform);
  for (std::uint32_t v = refined.finer[0].first_vertex; v < refined.vertex_count(); ++v) {
    const V3i at = refined.place_of(v).at;
    const std::size_t there = frame.vertex_index(at.x, at.y, at.z);
    ASSERT_EQ(a.variance[v], b.variance[there]);
    for (int i = 0; i < 36; ++i) ASSERT_EQ(a.at(v)[i], b.at(there)[i]);
  }
}

TEST(LatticeBake, TheSameAtAnyThreadCountAndFromParts) {
  const LitScene lit = make_lit_scene(small_room());
  GridBakeParams params = small_bake(3);
  const GridAccumulator whole = bake_grid_sums(lit, params);
  EXPECT_GT(whole.vertex_count_of(2), 1000U);
  params.threads = 1;
  const GridAccumulator one = bake_grid_sums(lit, params);
  EXPECT_EQ(whole.sums, one.sums);
  EXPECT_EQ(whole.guard, one.guard);
  EXPECT_EQ(static_cast<const Lattice&>(whole), static_cast<const Lattice&>(one));
  std::vector<GridAccumulator> parts;
  for (const auto& range : {std::pair(20'001, 60'000), std::pair(0, 20'001)}) {
    params.photon_range = range;
    parts.push_back(bake_grid_sums(lit, params));
  }
  const GridAccumulator merged = merge(parts, {"b", "a"});
  EXPECT_EQ(merged.sums, whole.sums);
  EXPECT_EQ(merged.metadata, whole.metadata);
  params.levels = 2;
  parts[1] = bake_grid_sums(lit, params);
  EXPECT_THROW(merge(parts, {"b", "a"}), Error);
}

// Stored vertices count, not those of the box.
TEST(LatticeBake, MemoryIsThatOfStoredVertices) {
  const Scene scene = small_room();
  GridBakeParams params = small_bake(1);
  params.voxel_size_m = 0.02F;
  params.threads = 1;
  const Lattice uniform = default_lattice(scene, params);
  params.levels = 4;
  const Lattice lattice = default_lattice(scene, params);
  EXPECT_LT(double(lattice.vertex_count()), 0.5 * double(uniform.vertex_count()));
  params.max_memory_bytes = std::uint64_t(lattice.vertex_count() * 1500);
  EXPECT_NO_THROW(check_grid_memory(scene, lattice, params));
  EXPECT_THROW(check_grid_memory(scene, uniform, params), Error);
  params.max_memory_bytes = std::uint64_t(lattice.vertex_count() * 500);
  EXPECT_THROW(check_grid_memory(scene, lattice, params), Error);
  params.max_memory_bytes = 1000;
  EXPECT_THROW(default_lattice(scene, params), Error);  // the tables alone
  params.estimator = Estimator::face;
  params.max_memory_bytes = 0;
  params.lattice = lattice;
  EXPECT_THROW(bake_grid_sums(make_lit_scene(scene), params), ParameterError);
}

// An even sky over next to nothing: E is pi L everywhere, on any level and between them. At 300 points with standard
// errors of their own, 5 of these are a false alarm once in 6,000 runs; the mean of all, correlated as they are, came
// to 0.2 % of pi.
TEST(LatticeBake, EvenLightComesOutEvenAcrossLevels) {
  Scene scene;
  scene.name = "even light";
  const int black = add_lambert(scene, Rgb(0, 0, 0));
  add_mesh(scene, make_quad(V3f(9, 9, 9), V3f(1e-3F, 0, 0), V3f(0, 1e-3F, 0), black));
  scene.environment = uniform_environment(Rgb(1, 1, 1));
  GridBakeParams params;
  GridFrame coarsest = coarsest_frame(V3i(6, 6, 6), true);
  coarsest.spacing_m = V3f(0.5F, 0.5F, 0.5F);
  coarsest.origin_m = coarsest.direction_to_world(V3f(-1.25F, -1.25F, -1.25F));
  params.lattice = make_lattice(coarsest, {{V3i(0, 0, 0), V3i(2, 1, 1)}, {V3i(1, 1, 1), V3i(4, 3, 2)}});
  params.photons = 400'000;
  params.include_direct = true;
  const IrradianceGrid grid = resolve(bake_grid_sums(make_lit_scene(scene), params));
  RandomStream random(2, StreamPurpose::test, 0);
  double sum = 0;
  std::array<int, 3> entries{};
  for (int i = 0; i < 300; ++i) {
    const V3f p = coarsest.to_world(V3f(random.next(), random.next(), random.next()) * 5.0F);
    const V3f n = V3f(random.next() - 0.5F, random.next() - 0.5F, random.next() - 0.5F).normalized();
    const Footprint footprint =
        make_footprint(grid, {.p = p, .ng = n, .nudge_voxels = 0.25F}, Interpolation::trilinear);
    const float e = irradiance(grid, footprint, n, Reconstruction::optimal).x;
    EXPECT_NEAR(e, pi, 5 * irradiance_standard_error(grid, footprint).x);
    sum += double(e);
    for (int k = 0; k < footprint.count; ++k) ++entries[std::size_t(grid.level_of(footprint.vertex[std::size_t(k)]))];
  }
  EXPECT_NEAR(sum / 300, double(pi), 0.01 * double(pi));
  for (const int count : entries) EXPECT_GT(count, 20);
}

}  // namespace
}  // namespace ivory
