// Grids of light probes, path-traced one by one, against closed forms and photons.
#include "tracer/bake/field/probe_baker.h"

#include <cmath>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/field/lookup.h"
#include "grid/field/resolve.h"
#include "tests/support/lit_scene.h"
#include "tests/support/paths.h"
#include "tests/support/statistics.h"
#include "tracer/bake/field/baker.h"
#include "tracer/gltf/loader.h"

namespace ivory {
namespace {

GridBakeParams small() {
  GridBakeParams params;
  params.resolution = V3i(3, 3, 3);
  params.threads = 2;
  return params;
}

// A closed box whose walls all shine: indirect light comes evenly, L = L_e rho / (1 - rho), E = pi L.
TEST(ProbeBaker, FurnaceIsEvenForEveryBasis) {
  const float rho = 0.5F;
  const LitScene lit = make_lit_scene(furnace(rho, Rgb(2, 1, 0.5F)));
  for (const Basis basis : all_bases) {
    GridBakeParams params = small();
    params.basis = basis;
    const IrradianceGrid grid = bake_grid_by_probes(lit, params, 1024);
    ASSERT_EQ(grid.vertex_count(), 27);
    for (std::size_t v = 0; v < 27; ++v) {
      if (grid.visible_fraction[v] <= 0) continue;
      Footprint one;
      one.count = 1;
      one.vertex[0] = std::uint32_t(v);
      one.weight[0] = 1;
      const V3f n = V3f(1, 2, -2).normalized();
      const Rgb e = irradiance(grid, one, n, Reconstruction::optimal);
      // Off by noise, five of whose standard errors are met in one of a million; they are those of independent paths.
      EXPECT_NEAR(e.x, pi * 2, 5 * irradiance_standard_error(grid, one).x) << name_of(basis) << v;
      EXPECT_NEAR(e.z, pi * 0.5F, 5 * irradiance_standard_error(grid, one).z) << name_of(basis) << v;
      EXPECT_LT(irradiance_standard_error(grid, one).x, 0.06F * pi * 2) << name_of(basis);
    }
  }
}

// Both are right where light hardly varies within a cell: E of the two is compared by what each says of its noise.
TEST(ProbeBaker, AgreesWithPhotonsInTheCornellBox) {
  const LitScene lit = make_lit_scene(load_gltf(std::string(source_folder) + "/scenes/cornell_box.gltf", {}).scene);
  GridBakeParams params;
  params.resolution = V3i(11, 11, 11);
  params.threads = 2;
  const IrradianceGrid probes = bake_grid_by_probes(lit, params, 256);
  params.photons = 200'000;
  const IrradianceGrid photons = resolve(bake_grid_sums(lit, params));
  ASSERT_EQ(probes.vertex_count(), photons.vertex_count());
  EXPECT_EQ(probes.visible_fraction, photons.visible_fraction);
  EXPECT_EQ(find_int(probes.metadata, "probe_rays"), 256);
  double difference = 0;
  double mean = 0;
  int count = 0;
  for (std::size_t v = 0; v < probes.vertex_count(); ++v) {
    if (probes.visible_fraction[v] < 1) continue;  // whole cells: the cell's mean is the light at its middle, nearly
    Footprint one;
    one.count = 1;
    one.vertex[0] = std::uint32_t(v);
    one.weight[0] = 1;
    for (const V3f& n : {V3f(0, 1, 0), V3f(0, -1, 0), V3f(0.6F, 0, 0.8F)}) {
      const double a = irradiance(probes, one, n, Reconstruction::optimal).y;
      const double b = irradiance(photons, one, n, Reconstruction::optimal).y;
      difference += a - b;
      mean += b;
      ++count;
    }
  }
  ASSERT_GT(count, 1000);
  // On the whole: noise leaves a few thousandths, and so does light's second derivative over a cell.
  EXPECT_NEAR(difference / mean, 0, 0.01);
}

TEST(ProbeBaker, DoesNotDependOnThreads) {
  const LitScene lit = make_lit_scene(load_gltf(std::string(source_folder) + "/scenes/cornell_box.gltf", {}).scene);
  GridBakeParams params = small();
  const IrradianceGrid two = bake_grid_by_probes(lit, params, 16);
  params.threads = 1;
  const IrradianceGrid one = bake_grid_by_probes(lit, params, 16);
  EXPECT_EQ(one.moments, two.moments);
  EXPECT_EQ(one.guard, two.guard);
  params.seed = 2;
  EXPECT_NE(bake_grid_by_probes(lit, params, 16).moments, one.moments);
}

TEST(ProbeBaker, RefusesWhatOnlyPhotonsKeep) {
  const LitScene lit = make_lit_scene(furnace(0.5F, Rgb(1, 1, 1)));
  GridBakeParams params = small();
  params.include_direct = true;
  EXPECT_THROW(bake_grid_by_probes(lit, params, 16), ParameterError);
  params.include_direct = false;
  params.groups.emplace();
  EXPECT_THROW(bake_grid_by_probes(lit, params, 16), ParameterError);
}

}  // namespace
}  // namespace ivory
