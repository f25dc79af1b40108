// Look-ups of many points at once beside those one by one.
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/field/batch/lookup.h"
#include "grid/field/guard.h"
#include "grid/field/lookup.h"
#include "tests/support/random_lattice.h"

namespace ivory {
namespace {

// Where vertices are buried, unlit, see a part of their cells and have no to four planes, all up to chance.
IrradianceGrid random_grid(const Lattice& lattice, Basis basis, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::normal_distribution<float> normal;
  IrradianceGrid grid;
  static_cast<Lattice&>(grid) = lattice;
  grid.basis = basis;
  const std::size_t count = lattice.vertex_count();
  grid.guard.assign(count, {});
  for (std::size_t v = 0; v < count; ++v) {
    const float kind = uniform(random);
    grid.visible_fraction.push_back(kind < 0.1F ? 0 : kind < 0.4F ? std::ceil(uniform(random) * 64) / 64 : 1.0F);
    const bool lit = grid.visible_fraction[v] > 0 && uniform(random) < 0.8F;
    // Some are lit, and yet their first moment is 0.
    for (int i = 0; i < grid.stride(); ++i)
      grid.moments.push_back(lit && (i > 0 || kind < 0.9F) ? normal(random) + 2 : 0);
    grid.variance.push_back(lit ? Rgb(1, 2, 3) * uniform(random) : Rgb(0, 0, 0));
    for (std::size_t k = 0; k < 4; ++k) {
      if (uniform(random) < 0.5F) continue;
      const V3f n = V3f(normal(random), normal(random), normal(random)).normalized();
      grid.guard[v].words[k] = pack({n, uniform(random) * 1.2F - 0.1F});
    }
  }
  return grid;
}

struct Points {
  std::vector<V3f> p;
  std::vector<V3f> ng;
  std::vector<V3f> n;
};
Points random_points(const GridFrame& frame, std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-0.1F, 1.1F);
  std::normal_distribution<float> normal;
  Points out;
  for (std::size_t i = 0; i < count; ++i) {
    out.p.push_back(frame.to_world(V3f(uniform(random), uniform(random), uniform(random)) * V3f(frame.size)));
    const bool whole = i % 11 == 0;  // axis by axis, as walls stand: plane coordinates are alike, and -0 is met
    const V3f n = V3f(normal(random), whole ? 0 : normal(random), whole ? -0.0F : normal(random)).normalized();
    out.ng.push_back(i % 7 == 0 ? V3f(0, 0, 0) : n);
    out.n.push_back(n);
  }
  return out;
}

bool same_bits(const Rgb& a, const Rgb& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// The same numbers to the last bit, whatever the lattice, the basis and the way of reading.
TEST(BatchedLookup, IsThatOfOneByOne) {
  const std::vector<Lattice> lattices{coarsest_frame(V3i(7, 5, 6), true), coarsest_frame(V3i(2, 3, 2), false),
                                      random_lattice(V3i(6, 8, 4), 3, 0.2, 5)};
  for (const Lattice& lattice : lattices) {
    const Points points = random_points(lattice.frame, 601);  // no multiple of a block or of eight
    const LookupSpans at{points.p, points.ng};
    for (const Basis basis : all_bases) {
      const IrradianceGrid grid = random_grid(lattice, basis, 3);
      for (const Guard guard : {Guard::off, Guard::planes}) {
        for (const Interpolation interpolation : values_of<Interpolation>()) {
          for (const Reconstruction reconstruction : values_of<Reconstruction>()) {
            if (!reads(reconstruction, basis)) continue;
            const LookupParams params{.guard = guard, .interpolation = interpolation, .reconstruction = reconstruction};
            const auto all = lookup_irradiance(grid, at, points.n, params);
            const auto readings = lookup_readings(grid, at, points.n, params, 0.5F);
            for (std::size_t i = 0; i < points.p.size(); ++i) {
              const Footprint footprint = lookup_footprint(grid, points.p[i], points.ng[i], params);
              const Rgb e = irradiance(grid, footprint, points.n[i], reconstruction);
              ASSERT_TRUE(same_bits(all[i], e)) << i << " " << name_of(basis) << " " << name_of(guard) << " "
                                                << name_of(interpolation) << all[i] << e << lattice.levels();
              ASSERT_TRUE(same_bits(readings[i].e, e)) << i;
              ASSERT_TRUE(same_bits(readings[i].standard_error, irradiance_standard_error(grid, footprint, 0.5F))) << i;
              ASSERT_EQ(readings[i].seen, footprint.count > 0) << i;
              ASSERT_EQ(readings[i].met, !is_black(irradiance_standard_error(grid, footprint))) << i;
            }
          }
        }
      }
    }
  }
}

// One point more or less at a call changes nothing for the others.
TEST(BatchedLookup, DoesNotDependOnItsNeighbours) {
  const Lattice lattice = random_lattice(V3i(6, 8, 4), 3, 0.2, 5);
  const IrradianceGrid grid = random_grid(lattice, Basis::vectors, 3);
  const Points points = random_points(lattice.frame, 70);
  const auto all = lookup_irradiance(grid, {points.p, points.ng}, points.n, {});
  for (std::size_t first = 0; first < 70; ++first) {
    const std::size_t count = std::min<std::size_t>(1 + first % 9, 70 - first);
    const auto part =
        lookup_irradiance(grid, {std::span(points.p).subspan(first, count), std::span(points.ng).subspan(first, count)},
                          std::span(points.n).subspan(first, count), {});
    for (std::size_t i = 0; i < count; ++i) EXPECT_TRUE(same_bits(part[i], all[first + i])) << first << " " << i;
  }
  EXPECT_TRUE(lookup_irradiance(grid, {}, {}, {}).empty());
}

// A grid that was baked without guard has no planes to read by: it is read as it is.
TEST(BatchedLookup, GridsWithoutPlanesAreReadWithout) {
  const Lattice lattice = coarsest_frame(V3i(4, 4, 4), false);
  IrradianceGrid grid = random_grid(lattice, Basis::sh9, 3);
  grid.guard.clear();
  const Points points = random_points(lattice.frame, 100);
  const auto e = lookup_irradiance(grid, {points.p, points.ng}, points.n, {.guard = Guard::planes});
  for (std::size_t i = 0; i < points.p.size(); ++i)
    EXPECT_TRUE(same_bits(e[i], lookup_irradiance(grid, points.p[i], points.ng[i], points.n[i], {}))) << i;
}

TEST(BatchedLookup, PaperReadsVectorsOnly) {
  const Lattice lattice = coarsest_frame(V3i(4, 4, 4), false);
  const IrradianceGrid grid = random_grid(lattice, Basis::sh9, 3);
  const Points points = random_points(lattice.frame, 3);
  EXPECT_THROW(lookup_irradiance(grid, {points.p, points.ng}, points.n, {.reconstruction = Reconstruction::paper}),
               ParameterError);
}

}  // namespace
}  // namespace ivory
