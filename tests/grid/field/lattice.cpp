// Grids of several spacings: numbering, and look-ups across levels.
#include "grid/field/lattice.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/field/lookup.h"
#include "tests/support/random_lattice.h"

namespace ivory {
namespace {

V3f random_point(const GridFrame& frame, std::mt19937& random, float beyond = 0) {
  std::uniform_real_distribution<float> uniform(0, 1);
  V3f index;
  for (int axis = 0; axis < 3; ++axis)
    index[axis] = uniform(random) * (float(frame.size[axis]) + 2 * beyond) - 0.5F - beyond;
  return frame.to_world(index);
}

// Values by [vertex] as the first function of a basis of one such, so that E is what the footprint reads.
IrradianceGrid grid_of(const Lattice& lattice, const std::vector<float>& values) {
  IrradianceGrid grid;
  static_cast<Lattice&>(grid) = lattice;
  grid.basis = Basis::ambient_cube;
  const std::size_t count = lattice.vertex_count();
  for (std::size_t v = 0; v < count; ++v) grid.moments.insert(grid.moments.end(), 18, values[v]);
  grid.visible_fraction.assign(count, 1);
  grid.variance.assign(count, Rgb(0, 0, 0));
  return grid;
}

float read(const IrradianceGrid& grid, const V3f& p, const LookupParams& params) {
  return lookup_irradiance(grid, p, V3f(0, 1, 0), V3f(0, 1, 0), params).x;
}

TEST(Lattice, NumbersAndPlacesGoBothWays) {
  const Lattice lattice = random_lattice(V3i(6, 4, 8), 4, 0.02, 1);
  ASSERT_EQ(lattice.levels(), 4);
  std::set<std::array<int, 4>> places;
  for (std::uint32_t v = 0; v < lattice.vertex_count(); ++v) {
    const VertexPlace place = lattice.place_of(v);
    places.insert({place.level, place.at.x, place.at.y, place.at.z});
    if (place.level == 0) {
      EXPECT_EQ(lattice.frame.vertex_index(place.at.x, place.at.y, place.at.z), v);
    } else {
      EXPECT_EQ(lattice.finer[std::size_t(place.level - 1)].vertex_at(place.at), v);
    }
  }
  EXPECT_EQ(places.size(), lattice.vertex_count());
}

// A cell and the eight cells of the next level that part it fill the same box.
TEST(Lattice, CellsTileEachOther) {
  const Lattice lattice = random_lattice(V3i(6, 4, 8), 3, 0.02, 2);
  for (int level = 1; level < 3; ++level) {
    const GridFrame& coarse = lattice.frame_of(level - 1);
    const GridFrame& fine = lattice.frame_of(level);
    for (const V3i& at : {V3i(0, 0, 0), V3i(3, 2, 5), V3i(5, 3, 7)}) {
      for (int corner = 0; corner < 8; ++corner) {
        const V3i side(corner & 1, corner >> 1 & 1, corner >> 2);
        const V3f half = V3f(side) - V3f(0.5F, 0.5F, 0.5F);
        // Positions of order 10.
        EXPECT_LT((coarse.to_world(V3f(at) + half) - fine.to_world(V3f(at * 2 + side) + half)).length(), 1e-5F);
      }
    }
  }
  const GridFrame back = coarser_frame(lattice.frame_of(2), 2);
  EXPECT_EQ(back.size, lattice.frame.size);
  EXPECT_EQ(back.spacing_m, lattice.frame.spacing_m);
  EXPECT_LT((back.origin_m - lattice.frame.origin_m).length(), 1e-5F);
}

// What look-ups rest on: around a brick the next coarser level is there. And the distances in the tables, by the slow
// road.
TEST(Lattice, CoarserLevelsAreCompleteAroundABrick) {
  const Lattice lattice = random_lattice(V3i(10, 6, 8), 4, 0.004, 3);
  for (std::size_t i = 0; i < lattice.finer.size(); ++i) {
    const BrickLevel& level = lattice.finer[i];
    V3i at;
    int absent = 0;
    for (at.z = 0; at.z < level.bricks.z; ++at.z) {
      for (at.y = 0; at.y < level.bricks.y; ++at.y) {
        for (at.x = 0; at.x < level.bricks.x; ++at.x) {
          const std::uint32_t entry = level.table[level.brick_index(at)];
          if (entry < no_brick) {
            for (int n = 0; i > 0 && n < 27; ++n) {
              const V3i near = at + V3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
              const BrickLevel& coarser = lattice.finer[i - 1];
              if (near.x < 0 || near.y < 0 || near.z < 0 || near.x >= level.bricks.x || near.y >= level.bricks.y ||
                  near.z >= level.bricks.z)
                continue;
              EXPECT_LT(coarser.table[coarser.brick_index(near / 2)], no_brick);
            }
            continue;
          }
          ++absent;
          int nearest = 255;
          for (const V3i& other : level.stored) {
            const V3i d = other - at;
            nearest = std::min(nearest, std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}));
          }
          EXPECT_EQ(entry - no_brick, std::uint32_t(nearest));
        }
      }
    }
    EXPECT_GT(absent, 0) << "nothing was tested";
  }
}

// Weights of 1 in all, of vertices that are there, whatever the bricks; no more of them than the footprint holds, and
// evenly lit grids read even.
TEST(Lattice, EvenLightIsReadExactly) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const Lattice lattice = random_lattice(V3i(6, 6, 8), 2 + trial % 4, trial < 10 ? 0.002 : 0.1, 10 + trial);
    const IrradianceGrid grid = grid_of(lattice, std::vector<float>(lattice.vertex_count(), 2.5F));
    for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::tricubic}) {
      const LookupParams params{.guard = Guard::off, .interpolation = interpolation};
      for (int i = 0; i < 500; ++i) {
        const V3f p = random_point(lattice.frame, random, 1);
        const Footprint footprint =
            make_footprint(lattice, {.p = p, .ng = V3f(0, 1, 0), .nudge_voxels = 0.25F}, interpolation);
        EXPECT_LE(footprint.count, interpolation == Interpolation::trilinear ? 16 : 128);
        float sum = 0;
        for (std::size_t e = 0; e < std::size_t(footprint.count); ++e) {
          EXPECT_LT(footprint.vertex[e], lattice.vertex_count());
          EXPECT_GE(footprint.weight[e], 0);
          sum += footprint.weight[e];
        }
        EXPECT_NEAR(sum, 1, 2e-6F);  // of up to 128 roundings
        EXPECT_NEAR(read(grid, p, params), 2.5F, 1e-5F);
      }
    }
  }
}

// E along lines through borders of levels changes by no more than its weights may: by a step of s voxels of the finest
// level an axis' weights change by at most 2 s in all (tricubic: 1.5 s), three axes by 6 s; what the fine level passes
// on changes by as much, and the coarser levels' own weights by less. Values lie between 0 and 1, so E could move by
// 12 s; half of them 0 and half 1, it moved by 0.54 s at most. A jump to other vertices is 0.3 of a value or so.
TEST(Lattice, LookUpsHaveNoJumps) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int trial = 0; trial < 6; ++trial) {
    const Lattice lattice = random_lattice(V3i(6, 6, 6), 3 + trial % 2, 0.02, 20 + trial, trial % 3 != 0);
    std::vector<float> values(lattice.vertex_count());
    for (float& v : values) v = uniform(random) < 0.5F ? 0 : 1;
    const IrradianceGrid grid = grid_of(lattice, values);
    const V3f& h = lattice.finest_frame().spacing_m;
    const float step_voxels = 0.02F;
    for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::tricubic}) {
      const LookupParams params{.guard = Guard::off, .interpolation = interpolation};
      float largest = 0;
      for (int line = 0; line < 4; ++line) {
        const V3f from = random_point(lattice.frame, random);
        const V3f to = random_point(lattice.frame, random);
        const auto steps = int((to - from).length() / (step_voxels * std::min({h.x, h.y, h.z})));
        float last = read(grid, from, params);
        for (int i = 1; i <= steps; ++i) {
          const float e = read(grid, from + (to - from) * (float(i) / float(steps)), params);
          largest = std::max(largest, std::abs(e - last));
          last = e;
        }
      }
      EXPECT_LT(largest, 2 * step_voxels);
      EXPECT_GT(largest, 0.1F * step_voxels) << "nothing changed";
    }
  }
}

// Refined everywhere, only the finest level is read, as the uniform grid of its spacing is.
TEST(Lattice, RefinedEverywhereItReadsAsAUniformGrid) {
  const Lattice lattice = whole_lattice(coarsest_frame(V3i(4, 2, 6), true), 3);
  const GridFrame& fine = lattice.finest_frame();
  ASSERT_EQ(lattice.vertex_count_of(2), fine.vertex_count());
  std::mt19937 random(6);
  for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::tricubic}) {
    for (int i = 0; i < 500; ++i) {
      const V3f p = random_point(lattice.frame, random, 1);
      const Footprint in_bricks = make_footprint(lattice, {.p = p}, interpolation);
      const Footprint uniform = make_footprint(fine, p, interpolation);
      ASSERT_EQ(in_bricks.count, uniform.count);
      for (std::size_t e = 0; e < std::size_t(uniform.count); ++e) {
        const VertexPlace place = lattice.place_of(in_bricks.vertex[e]);
        EXPECT_EQ(place.level, 2);
        EXPECT_EQ(fine.vertex_index(place.at.x, place.at.y, place.at.z), uniform.vertex[e]);
        EXPECT_EQ(in_bricks.weight[e], uniform.weight[e]);
      }
    }
  }
}

// Deep inside bricks the finest level alone is read, deep in the open the coarsest.
TEST(Lattice, ReadsTheFinestLevelThatIsThere) {
  const GridFrame coarsest = coarsest_frame(V3i(16, 16, 16), false);
  const Lattice lattice = refine(Lattice(coarsest), 0, {V3i(0, 0, 0)});
  ASSERT_EQ(lattice.levels(), 2);
  EXPECT_EQ(lattice.finer[0].stored.size(), 8U);
  const auto levels_at = [&](const V3f& coarse_index) {
    const Footprint f = make_footprint(lattice, {.p = coarsest.to_world(coarse_index)}, Interpolation::trilinear);
    std::array<float, 2> weight{};
    for (std::size_t e = 0; e < std::size_t(f.count); ++e)
      weight[std::size_t(lattice.level_of(f.vertex[e]))] += f.weight[e];
    return weight;
  };
  EXPECT_EQ(levels_at(V3f(1, 2, 1)), (std::array{0.0F, 1.0F}));
  EXPECT_EQ(levels_at(V3f(6, 9, 4)), (std::array{1.0F, 0.0F}));
  // The bricks end at 3.5; the last fine vertex stands at 3.25, the first that is not there at 3.75.
  EXPECT_NEAR(levels_at(V3f(3.5F, 1, 1))[1], 0.5F, 1e-5F);
}

TEST(Lattice, MovesAsAWhole) {
  const Lattice lattice = random_lattice(V3i(4, 4, 4), 3, 0.05, 7);
  std::mt19937 random(8);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<float> values(lattice.vertex_count());
  for (float& v : values) v = uniform(random);
  const IrradianceGrid near = grid_of(lattice, values);
  IrradianceGrid far = near;
  far.anchor_m = V3d(4e6, -1e5, 3e6);
  set_anchor(far, V3d(4e6 + 16, -1e5 - 2, 3e6 + 4));
  for (int i = 0; i < 200; ++i) {
    const V3f p = random_point(lattice.frame, random);
    const V3f moved = p - V3f(16, -2, 4);
    EXPECT_NEAR(read(near, p, {.guard = Guard::off}), read(far, moved, {.guard = Guard::off}), 1e-4F);
  }
}

TEST(Lattice, RefusesWhatCannotBe) {
  const GridFrame odd = coarsest_frame(V3i(5, 4, 4), false);
  const GridFrame even = coarsest_frame(V3i(4, 4, 4), false);
  EXPECT_THROW(make_lattice(odd, {{V3i(0, 0, 0)}}), ParameterError);
  EXPECT_EQ(make_lattice(odd, {{}, {}}).levels(), 1);
  EXPECT_THROW(make_lattice(even, {{V3i(0, 2, 0)}}), ParameterError);
  EXPECT_THROW(make_lattice(even, {{V3i(-1, 0, 0)}}), ParameterError);
  EXPECT_THROW(make_lattice(even, std::vector<std::vector<V3i>>(max_levels, {V3i(0, 0, 0)})), ParameterError);
  EXPECT_THROW(refine(Lattice(even), 0, {V3i(1, 0, 0)}), ParameterError);
}

}  // namespace
}  // namespace ivory
