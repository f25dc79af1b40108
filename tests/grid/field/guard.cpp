// The compact guard's packing and the footprints it restricts.
#include "grid/field/guard.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "grid/field/lookup.h"
#include "tests/support/inner_edge.h"

namespace ivory {
namespace {

TEST(GuardPlane, PacksWithinItsSteps) {
  std::mt19937 generator(1);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> distance(-1.9F, 1.9F);
  for (int i = 0; i < 10'000; ++i) {
    const GuardPlane plane{V3f(normal(generator), normal(generator), normal(generator)).normalized(),
                           distance(generator)};
    const std::uint32_t word = pack(plane);
    ASSERT_NE(word, 0U);
    const auto back = unpack(word);
    ASSERT_TRUE(back);
    // Half a step is 1/1023 an axis, so at most (1, 1, 2)/1023 on the octahedron, whose faces lie as near as
    // 1/sqrt(3) to the centre: sqrt(6) sqrt(3) / 1023.
    EXPECT_LT((back->normal - plane.normal).length(), 0.00415F);
    EXPECT_NEAR(back->distance, plane.distance, 0.5F * 4 / 4094 + 1e-6F);
  }
  EXPECT_FALSE(unpack(0));
}

TEST(Guard, SeesWhatNoPlaneCutsOff) {
  GuardRecord record;
  EXPECT_LE(hidden_by(record, V3f(1, 1, 1)), 0);
  record.words[0] = pack({V3f(1, 0, 0), 0.3F});
  record.words[1] = pack({V3f(0, -1, 0), 0.5F});
  EXPECT_LE(hidden_by(record, V3f(0.25F, 0, 0)), 0);
  EXPECT_GT(hidden_by(record, V3f(0.35F, 0, 0)), 0);
  EXPECT_GT(hidden_by(record, V3f(0, -0.6F, 0)), 0);
  EXPECT_LE(hidden_by(record, V3f(0, 0.9F, 0)), 0);
}

IrradianceGrid small_grid() {
  IrradianceGrid grid;
  grid.frame.size = V3i(4, 4, 4);
  grid.basis = Basis::ambient_cube;
  grid.moments.assign(64 * 18, 0);
  for (std::size_t v = 0; v < 64; ++v) std::fill_n(grid.moments.begin() + std::ptrdiff_t(v * 18), 18, float(v % 4));
  grid.visible_fraction.assign(64, 1.0F);
  grid.variance.assign(64, Rgb(0, 0, 0));
  return grid;
}

TEST(Footprint, WeightsAddUpToOneAndReproduceLinearFields) {
  const IrradianceGrid grid = small_grid();
  for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::tricubic}) {
    for (const float x : {1.0F, 1.25F, 1.7F, 2.0F}) {
      const Footprint f = make_footprint(grid.frame, V3f(x, 1.5F, 1.2F), interpolation);
      float sum = 0;
      for (int i = 0; i < f.count; ++i) sum += f.weight[std::size_t(i)];
      EXPECT_NEAR(sum, 1, 1e-6F);
      // Both interpolations reproduce linear fields away from the border.
      if (interpolation == Interpolation::trilinear || x < 2) {
        EXPECT_NEAR(irradiance(grid, f, V3f(0, 1, 0), Reconstruction::optimal).x, x, 1e-5F);
      }
    }
  }
}

TEST(Footprint, HiddenAndEmptyVerticesAreLeftOut) {
  IrradianceGrid grid = small_grid();
  const V3f p(1.5F, 1.5F, 1.5F);
  Footprint f = make_footprint(grid.frame, p, Interpolation::trilinear);
  VisibleEntries visible;
  for (std::size_t i = 0; i < std::size_t(f.count); ++i) visible[i] = f.vertex[i] % 4 == 1;
  restrict_footprint(grid, visible, f);
  EXPECT_NEAR(irradiance(grid, f, V3f(0, 1, 0), Reconstruction::optimal).x, 1, 1e-6F);

  // Nothing seen, nothing stored: said so, and the weights stay.
  f = make_footprint(grid.frame, p, Interpolation::trilinear);
  EXPECT_EQ(restrict_footprint(grid, VisibleEntries(), f), 0);
  EXPECT_NEAR(irradiance(grid, f, V3f(0, 1, 0), Reconstruction::optimal).x, 1.5F, 1e-6F);
  for (std::size_t v = 0; v < 64; ++v) {
    if (v % 4 == 1) grid.visible_fraction[v] = 0;
  }
  EXPECT_NEAR(restrict_footprint(grid, VisibleEntries().set(), f), 0.5F, 1e-6F);
  EXPECT_NEAR(irradiance(grid, f, V3f(0, 1, 0), Reconstruction::optimal).x, 2, 1e-6F);
}

// A blend of both interpolations has more entries than a 64-bit number has bits.
TEST(Footprint, TheLastEntriesOfTheLargestFootprintAreSeenOnTheirOwn) {
  const IrradianceGrid grid = small_grid();
  const V3f p(1.4F, 1.5F, 1.6F);
  Footprint f = blend(make_footprint(grid.frame, p, Interpolation::trilinear),
                      make_footprint(grid.frame, p, Interpolation::tricubic), 0.5F);
  ASSERT_EQ(f.count, 72);
  VisibleEntries visible;
  visible.set(70);
  EXPECT_GT(restrict_footprint(grid, visible, f), 0);
  for (std::size_t i = 0; i < 72; ++i) EXPECT_NEAR(f.weight[i], i == 70 ? 1 : 0, 1e-6F) << i;
  EXPECT_TRUE(visible_by_guard(grid, {.p = p, .ng = V3f(0, 1, 0)}, f).all());
}

// A wall with its inner face at x = 3.1, its outer at 3.3, past the outermost vertices. Those know of it; the layers
// behind, more than a voxel away, do not.
TEST(Lookup, TheOutsideOfAWallThatNoVertexSeesIsDark) {
  IrradianceGrid grid = small_grid();
  std::fill(grid.moments.begin(), grid.moments.end(), 1.0F);
  grid.guard.assign(64, {});
  for (std::size_t v = 3; v < 64; v += 4) grid.guard[v].words[0] = pack({V3f(1, 0, 0), 0.1F});
  for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::tricubic}) {
    for (const float y : {0.2F, 1.5F, 2.9F, 4.0F}) {
      const LookupParams params{.guard = Guard::planes, .interpolation = interpolation};
      const V3f out(1, 0, 0);
      const Footprint footprint = lookup_footprint(grid, V3f(3.3F, y, 1.4F), out, params);
      EXPECT_EQ(footprint.count, 0) << y;
      EXPECT_EQ(irradiance_standard_error(grid, footprint), Rgb(0, 0, 0));
      EXPECT_EQ(lookup_irradiance(grid, V3f(3.3F, y, 1.4F), out, out, params), Rgb(0, 0, 0)) << y;
      EXPECT_NEAR(lookup_irradiance(grid, V3f(3.1F, y, 1.4F), -out, -out, params).x, 1, 1e-6F) << y;
    }
  }
}

// Without the rules of yield.h the vertices behind the edge hold up to a half of the weight.
TEST(Lookup, InnerEdgesHaveNoSeam) {
  for (const float outside_lux : {0.0F, 5.0F}) {
    const IrradianceGrid grid = inner_edge(outside_lux);
    for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::tricubic}) {
      for (const SurfacePoint& at : inner_edge_points()) {
        EXPECT_NEAR(lookup_irradiance(grid, at.p, at.n, at.n, {.interpolation = interpolation}).x, 1, 1e-5F)
            << at.p << at.n << " " << outside_lux << " " << name_of(interpolation);
      }
    }
  }
}

// Behind a thin wall the lit vertices are the wrong ones: unlit ones give way to none behind the surface.
TEST(Lookup, TheDarkSideOfAThinWallStaysDark) {
  IrradianceGrid grid = inner_edge(0);
  for (std::size_t v = 0; v < 64; ++v) {  // the wall at x = 0.3 alone; light beyond it, and planes that missed it
    const bool lit = grid.frame.vertex_coordinates(v).x == 0;
    std::fill_n(grid.moments.begin() + std::ptrdiff_t(18 * v), 18, lit ? 1.0F : 0.0F);
    grid.guard[v] = {};
  }
  const V3f n(1, 0, 0);
  for (const SurfacePoint& at : inner_edge_points()) {
    if (at.n != n) continue;
    // As much as the planes let through, by weight; and nothing where those in front know of the wall.
    EXPECT_NEAR(lookup_irradiance(grid, at.p, n, n, {}).x, 0.45F, 1e-5F);
  }
  for (std::size_t v = 1; v < 64; v += 4) grid.guard[v].words[0] = pack({V3f(-1, 0, 0), 0.7F});
  for (const SurfacePoint& at : inner_edge_points()) {
    if (at.n != n) continue;
    EXPECT_EQ(lookup_irradiance(grid, at.p, n, n, {}).x, 0);
  }
}

// Points within the nudge of a wall, facing it: what is read there is what is before the wall, whether the nudged point
// lies in it or behind it; from behind it nothing is. The last 3/16 of the nudge, 4.7 cm, remain.
TEST(Lookup, WallsNearerThanTheNudgeStayBehind) {
  for (const float thickness : {0.02F, 1.5F}) {
    const IrradianceGrid grid = before_a_wall(thickness);
    for (const Interpolation interpolation :
         {Interpolation::trilinear, Interpolation::tricubic, Interpolation::fitted}) {
      const LookupParams params{.interpolation = interpolation};
      for (float off = 0.053F; off < 0.5F; off += 0.01F) {
        for (const V3f& n : {V3f(1, 0, 0), V3f(0.8F, 0, 0.6F), V3f(0.8F, 0.6F, 0), V3f(-1, 0, 0)}) {
          const V3f p(1.4F - off, 1.3F, 1.6F);
          EXPECT_NEAR(lookup_irradiance(grid, p, n, n, params).x, 1, 1e-5F) << off << n << name_of(interpolation);
          if (thickness > 1) continue;
          const V3f mirrored(1.4F + thickness + off, 1.3F, 1.6F);
          EXPECT_EQ(lookup_irradiance(grid, mirrored, -n, -n, params).x, 0) << off << n << name_of(interpolation);
        }
      }
      // Surfaces of the wall itself.
      const V3f x(1, 0, 0);
      EXPECT_NEAR(lookup_irradiance(grid, V3f(1.4F, 1.3F, 1.6F), -x, -x, params).x, 1, 1e-5F);
      EXPECT_EQ(lookup_irradiance(grid, V3f(1.4F + thickness, 1.3F, 1.6F), x, x, params).x, 0);
    }
  }
}

TEST(GridFrame, VertexNumbersAndCoordinatesGoBothWays) {
  GridFrame frame;
  frame.size = V3i(3, 4, 5);
  for (std::size_t v = 0; v < frame.vertex_count(); ++v) {
    const V3i at = frame.vertex_coordinates(v);
    EXPECT_EQ(frame.vertex_index(at.x, at.y, at.z), v);
  }
}

TEST(Footprint, BlendMixesBoth) {
  const IrradianceGrid grid = small_grid();
  const Footprint a = make_footprint(grid.frame, V3f(1, 1.5F, 1.5F), Interpolation::trilinear);
  const Footprint b = make_footprint(grid.frame, V3f(1.5F, 1.5F, 1.5F), Interpolation::tricubic);
  EXPECT_NEAR(irradiance(grid, blend(a, b, 0.25F), V3f(0, 1, 0), Reconstruction::optimal).x, 1.375F, 1e-5F);
}

// A grid turned and moved together with the points and normals gives the same light.
TEST(Footprint, RotatedFrameReadsTheSame) {
  IrradianceGrid grid = small_grid();
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> uniform;
  for (float& m : grid.moments) m = uniform(generator);
  IrradianceGrid turned = grid;
  const float c = std::cos(1.1F);
  const float s = std::sin(1.1F);
  turned.frame.local_to_world = M33f(c, s, 0, -s, c, 0, 0, 0, 1);
  turned.frame.origin_m = V3f(3, -2, 7);
  for (int i = 0; i < 100; ++i) {
    const V3f p(uniform(generator) * 3, uniform(generator) * 3, uniform(generator) * 3);
    const V3f n = V3f(uniform(generator) - 0.5F, uniform(generator) - 0.5F, uniform(generator) - 0.5F).normalized();
    const V3f turned_p = p * turned.frame.local_to_world + turned.frame.origin_m;
    const V3f turned_n = n * turned.frame.local_to_world;
    const float plain =
        irradiance(grid, make_footprint(grid.frame, p, Interpolation::trilinear), n, Reconstruction::optimal).x;
    const float moved = irradiance(turned, make_footprint(turned.frame, turned_p, Interpolation::trilinear), turned_n,
                                   Reconstruction::optimal)
                            .x;
    EXPECT_NEAR(plain, moved, 1e-4F);  // positions of order 10 lose 1e-6 of a voxel, over values of order 1
  }
}

}  // namespace
}  // namespace ivory
