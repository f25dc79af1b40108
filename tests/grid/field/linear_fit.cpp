// Linear fits to what vertices measured: against a slow twin, on linear fields, and never below zero.
#include "grid/field/linear_fit.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "grid/field/guard.h"
#include "grid/field/lookup.h"

namespace ivory {
namespace {

// Made-up light and planes, some vertices noisy, some unlit.
IrradianceGrid random_grid(Basis basis, std::mt19937& random) {
  std::uniform_real_distribution<float> uniform;
  IrradianceGrid grid;
  grid.frame.size = V3i(5, 4, 6);
  grid.frame.spacing_m = V3f(0.5F, 0.7F, 0.4F);
  grid.basis = basis;
  grid.visible_fraction.assign(grid.frame.vertex_count(), 1.0F);
  grid.moments.assign(grid.frame.vertex_count() * std::size_t(grid.stride()), 0);
  const auto direction = [&] {
    return V3f(uniform(random) - 0.5F, uniform(random) - 0.5F, uniform(random) - 0.5F).normalized();
  };
  for (std::size_t v = 0; v < grid.frame.vertex_count(); ++v) {
    const float lux = uniform(random) < 0.2F ? 0 : std::pow(10.0F, 4 * uniform(random));
    float* m = grid.moments.data() + v * std::size_t(grid.stride());
    for (int light = 0; light < 3; ++light) {
      const auto f = eval(basis, direction());
      for (std::size_t k = 0; k < std::size_t(grid.stride()); ++k) m[k] += lux * f[k / 3];
    }
    grid.variance.push_back(Rgb(1, 1, 1) * (lux * lux * 0.01F * uniform(random)));
    GuardRecord record;
    for (std::size_t i = 0; i < std::size_t(uniform(random) * 3); ++i)
      record.words[i] = pack({direction(), 0.2F + uniform(random)});
    grid.guard.push_back(record);
  }
  return grid;
}

TEST(LinearFit, PlacesVerticesInTheMiddleOfWhatTheySee) {
  GuardRecord record;
  EXPECT_EQ(measured_at(record), V3f(0, 0, 0));
  record.words[0] = pack({V3f(1, 0, 0), 0.2F});
  record.words[2] = pack({V3f(0, -1, 0), 0.9F});  // beyond the cell
  // What packing rounds: half a step of distance and a thousandth of the normal.
  EXPECT_LT((measured_at(record) - V3f(-0.15F, 0, 0)).length(), 2e-3F);
}

// The normal equations of the four unknowns of a + g.(x - p), solved in double by elimination.
TEST(LinearFit, SolvesTheNormalEquations) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform;
  for (int trial = 0; trial < 200; ++trial) {
    const IrradianceGrid grid = random_grid(Basis::ambient_cube, random);
    const V3f index(uniform(random) * 4, uniform(random) * 3, uniform(random) * 5);
    const V3f p = grid.frame.to_world(index);
    Footprint seen = make_footprint(grid.frame, p, trial % 2 == 0 ? Interpolation::trilinear : Interpolation::tricubic);
    VisibleEntries visible;
    for (std::size_t i = 0; i < std::size_t(seen.count); ++i) visible[i] = uniform(random) < 0.6F;
    if (restrict_footprint(grid, visible, seen) == 0) continue;
    const Footprint fitted = fit_linear(grid, p, seen);
    const auto light = [&](std::size_t i) { return double(grid.at(seen.vertex[i])[0]); };
    double ridge = 0.03;
    for (std::size_t i = 0; i < std::size_t(seen.count); ++i)
      ridge += 300 * double(seen.weight[i]) * double(relative_variance(grid, seen.vertex[i]));
    std::array<std::array<double, 5>, 4> a{};
    for (std::size_t i = 0; i < std::size_t(seen.count); ++i) {
      const std::uint32_t v = seen.vertex[i];
      const V3f x = V3f(grid.frame.vertex_coordinates(v)) + measured_at(grid.guard[v]) - index;
      const std::array<double, 5> row{1, double(x.x), double(x.y), double(x.z), light(i)};
      for (std::size_t r = 0; r < 4; ++r) {
        for (std::size_t c = 0; c < 5; ++c) a[r][c] += double(seen.weight[i]) * row[r] * row[c];
      }
    }
    for (std::size_t r = 1; r < 4; ++r) a[r][r] += ridge;
    for (std::size_t pivot = 4; pivot-- > 1;) {
      for (std::size_t r = 0; r < pivot; ++r) {
        const double factor = a[r][pivot] / a[pivot][pivot];
        for (std::size_t c = 0; c < 5; ++c) a[r][c] -= factor * a[pivot][c];
      }
    }
    double read = 0;
    double sum = 0;
    double scale = 0;
    for (std::size_t i = 0; i < std::size_t(seen.count); ++i) {
      read += double(fitted.weight[i]) * light(i);
      sum += double(fitted.weight[i]);
      scale = std::max(scale, light(i));
    }
    EXPECT_NEAR(sum, 1, 2e-5);                           // 64 weights of either sign, rounded to 6e-8 of up to 4
    EXPECT_NEAR(read, a[0][4] / a[0][0], 1e-4 * scale);  // and a 3 x 3 inverse in float, of a condition below 100
  }
}

// Light that rises by 1 lux a metre along x; a wall at x = 0 with all vertices before it. Trilinear interpolation reads
// the field where it is nudged to; the fit, at the wall: of the slope a ridge of 0.03 beside a spread of 0.3 takes a
// tenth.
TEST(LinearFit, ReadsLinearFieldsAtTheSurface) {
  IrradianceGrid grid;
  grid.frame.size = V3i(6, 5, 5);
  grid.frame.origin_m = V3f(0.4F, 0, 0);
  grid.basis = Basis::vectors9;
  grid.visible_fraction.assign(150, 1.0F);
  grid.variance.assign(150, Rgb(0, 0, 0));
  for (std::size_t v = 0; v < 150; ++v) {
    const float lux = 5 + grid.frame.to_world(V3f(grid.frame.vertex_coordinates(v))).x;
    for (int k = 0; k < 27; ++k) grid.moments.push_back(k >= 9 && k < 18 ? lux : 0.0F);
  }
  const V3f n(1, 0, 0);
  const auto even = [&](float lux) {
    std::array<float, 27> m{};
    std::fill_n(m.begin() + 9, 9, lux);
    return irradiance(grid.basis, Reconstruction::optimal, m.data(), n).x;
  };
  for (const float y : {1.0F, 1.3F, 1.5F, 1.8F}) {
    const V3f p(0, y, 2.1F);
    const auto read = [&](Interpolation interpolation) {
      return lookup_irradiance(grid, p, n, n, {.guard = Guard::off, .interpolation = interpolation}).x / even(1);
    };
    EXPECT_NEAR(read(Interpolation::trilinear), 5.4F, 1e-4F);  // the nearest vertices
    EXPECT_NEAR(read(Interpolation::fitted), 5, 0.1F) << y;
  }
}

TEST(LinearFit, KeepsEvenLightAndIsNeverNegative) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform;
  for (const Basis basis : all_bases) {
    IrradianceGrid grid = random_grid(basis, random);
    IrradianceGrid even = grid;
    for (std::size_t v = 0; v < even.frame.vertex_count(); ++v) {
      for (std::size_t k = 0; k < std::size_t(even.stride()); ++k)
        even.moments[v * std::size_t(even.stride()) + k] = grid.moments[k];
    }
    for (int i = 0; i < 500; ++i) {
      const V3f p = grid.frame.to_world(V3f(uniform(random) * 6 - 1, uniform(random) * 5 - 1, uniform(random) * 7 - 1));
      const V3f n = V3f(uniform(random) - 0.5F, uniform(random) - 0.5F, uniform(random) - 0.5F).normalized();
      const LookupParams params{.interpolation = Interpolation::fitted};
      const Rgb e = lookup_irradiance(grid, p, n, n, params);
      EXPECT_TRUE(e.x >= 0 && std::isfinite(e.x)) << e;
      const Footprint footprint = lookup_footprint(even, p, n, params);
      if (footprint.count == 0) continue;
      const float expected = irradiance(basis, Reconstruction::optimal, even.at(0), n).x;
      EXPECT_NEAR(irradiance(even, footprint, n, Reconstruction::optimal).x, expected,
                  1e-4F * std::abs(even.at(0)[0]) + 1e-4F * expected + 1e-4F);
    }
  }
}

}  // namespace
}  // namespace ivory
