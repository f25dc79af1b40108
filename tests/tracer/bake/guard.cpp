// Leaks through a thin wall, and accuracy with and without the guard, on the bundled scenes.
#include <cmath>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "grid/field/resolve.h"
#include "tests/support/paths.h"
#include "tracer/bake/field/baker.h"
#include "tracer/gltf/loader.h"
#include "tracer/render/guard_rays.h"
#include "tracer/render/probe.h"

namespace ivory {
namespace {

struct SurfacePoint {
  V3f p;
  V3f n;
};

std::string scene_path(const std::string& name) { return std::string(source_folder) + "/scenes/" + name; }

// Columns x,y,z,nx,ny,nz below one heading.
std::vector<SurfacePoint> read_points(const std::string& name) {
  std::ifstream file(scene_path(name));
  std::vector<SurfacePoint> points;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream cells(line);
    SurfacePoint at;
    if (cells >> at.p.x >> at.p.y >> at.p.z >> at.n.x >> at.n.y >> at.n.z) points.push_back(at);
  }
  return points;
}

struct Baked {
  LitScene lit;

  explicit Baked(const std::string& name) : lit(make_lit_scene(load_gltf(scene_path(name)).scene)) {}
  IrradianceGrid bake(int long_side, Basis basis, Guard guard, std::uint64_t photons) const {
    GridBakeParams params;
    const V3f size = bounds(*lit.scene).size();
    params.voxel_size_m = std::max({size.x, size.y, size.z}) / float(long_side);
    params.basis = basis;
    params.guard = guard;
    params.photons = photons;
    return resolve(bake_grid_sums(lit, params));
  }
  double mean_irradiance(const IrradianceGrid& grid, Guard guard, const std::vector<SurfacePoint>& points) const {
    double sum = 0;
    for (const SurfacePoint& at : points)
      sum += double(lookup_irradiance(grid, &lit.intersector, at.p, at.n, at.n, {.guard = guard}).x);
    return sum / double(points.size());
  }
};

class Leak : public testing::TestWithParam<std::tuple<const char*, int, Basis>> {};

std::string leak_name(const testing::TestParamInfo<Leak::ParamType>& info) {
  return std::string(std::get<0>(info.param)) + "_" + std::to_string(std::get<1>(info.param)) + "_" +
         std::string(name_of(std::get<2>(info.param)));
}

INSTANTIATE_TEST_SUITE_P(ThinWall, Leak,
                         testing::Combine(testing::Values("leak_axis", "leak_rotated"), testing::Values(16, 32),
                                          testing::Values(Basis::vectors, Basis::sh9, Basis::ambient_cube)),
                         leak_name);

// E on the dark side of a 2 cm wall over mean E in the lit room; the truth is 0. What leaks does so
// whole vertices at a time, so 200,000 photons tell it as well as many.
TEST_P(Leak, GuardsHold) {
  const auto& [name, long_side, basis] = GetParam();
  const Baked baked(std::string(name) + ".gltf");
  const auto dark = read_points(std::string(name) + "_dark_points.csv");
  const auto lit = read_points(std::string(name) + "_lit_points.csv");
  ASSERT_EQ(dark.size(), 256U);
  ASSERT_EQ(lit.size(), 256U);
  const IrradianceGrid guarded = baked.bake(long_side, basis, Guard::rays, 200'000);
  const IrradianceGrid open = baked.bake(long_side, basis, Guard::off, 200'000);
  const auto leak = [&](const IrradianceGrid& grid, Guard guard) {
    return baked.mean_irradiance(grid, guard, dark) / baked.mean_irradiance(grid, guard, lit);
  };
  EXPECT_LE(leak(guarded, Guard::rays), 0.001);
  EXPECT_LE(leak(guarded, Guard::planes), 0.01);
  EXPECT_GT(leak(open, Guard::off), 0.05);  // the scene does test something
}

// Coarse grids have no vertex outside of a closed house, whose outer faces then must be dark; and nothing inside it may
// be, nor in the seams along its edges.
class OuterWalls : public testing::TestWithParam<std::tuple<const char*, int>> {};
std::string outer_walls_name(const testing::TestParamInfo<OuterWalls::ParamType>& at) {
  return std::string(std::get<0>(at.param)) + "_" + std::to_string(std::get<1>(at.param));
}
INSTANTIATE_TEST_SUITE_P(Rooms, OuterWalls,
                         testing::Combine(testing::Values("two_rooms", "room_boxes"), testing::Values(8, 16)),
                         outer_walls_name);

TEST_P(OuterWalls, AreDark) {
  const auto& [name, long_side] = GetParam();
  const Baked baked(std::string(name) + ".gltf");
  const Box3f box = bounds(*baked.lit.scene);
  std::vector<SurfacePoint> outside;
  for (int face = 0; face < 6; ++face) {
    V3f n(0, 0, 0);
    n[face / 2] = face % 2 == 0 ? -1.0F : 1.0F;
    for (int i = 0; i < 64; ++i) {
      V3f p = box.center();
      p[face / 2] = n[face / 2] < 0 ? box.min[face / 2] : box.max[face / 2];
      p[(face / 2 + 1) % 3] += (float(i % 8) / 7 - 0.5F) * 0.99F * box.size()[(face / 2 + 1) % 3];
      p[(face / 2 + 2) % 3] += (float(i / 8) / 7 - 0.5F) * 0.99F * box.size()[(face / 2 + 2) % 3];
      outside.push_back({p, n});
    }
  }
  const IrradianceGrid grid = baked.bake(long_side, Basis::vectors, Guard::rays, 60'000);
  const IrradianceGrid open = baked.bake(long_side, Basis::vectors, Guard::off, 60'000);
  EXPECT_GT(baked.mean_irradiance(open, Guard::off, outside), 0.05);  // lux: the scene does test something
  for (const Guard guard : {Guard::rays, Guard::planes})
    EXPECT_EQ(baked.mean_irradiance(grid, guard, outside), 0) << name_of(guard);
  if (std::string(name) != "room_boxes") return;
  const std::vector<SurfacePoint> inside = read_points("room_boxes_points.csv");
  for (const Guard guard : {Guard::rays, Guard::planes}) {
    const double mean = baked.mean_irradiance(grid, guard, inside);
    for (const SurfacePoint& at : inside)
      EXPECT_GT(baked.mean_irradiance(grid, guard, {at}), mean / 20) << at.p << " " << name_of(guard);
  }
}

// Indirect E over the surfaces of a furnished room against path-traced truth.
class FurnishedRoom : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Rooms, FurnishedRoom, testing::Values("room_boxes", "room_boxes_rotated"));

TEST_P(FurnishedRoom, GuardsMakeTheGridAccurate) {
  const Baked baked(std::string(GetParam()) + ".gltf");
  std::vector<SurfacePoint> points = read_points(std::string(GetParam()) + "_points.csv");
  // Every second point keeps the truth affordable.
  std::vector<ProbePoint> probes;
  for (std::size_t i = 0; i < points.size(); i += 2) probes.push_back({points[i].p, points[i].n});
  ProbeParams truth_params;
  truth_params.samples = 4096;
  truth_params.indirect_only = true;
  const auto truth = probe_scene(baked.lit, probes, truth_params);
  double least = 1e30;
  double most = 0;
  double noise = 0;
  for (const ProbeResult& t : truth) {
    least = std::min(least, double(t.e.x));
    most = std::max(most, double(t.e.x));
    noise += double(t.standard_error.x) * double(t.standard_error.x) / double(truth.size());
  }
  const IrradianceGrid guarded = baked.bake(32, Basis::vectors, Guard::rays, 8'000'000);
  const IrradianceGrid open = baked.bake(32, Basis::vectors, Guard::off, 1'000'000);
  // The truth's own variance is known and independent of the grid's error: taken off.
  const auto nrmse = [&](const IrradianceGrid& grid, Guard guard, Interpolation interpolation = {}) {
    const LookupParams lookup{.guard = guard, .interpolation = interpolation};
    double sum = 0;
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const ProbePoint& at = probes[i];
      const double e =
          double(lookup_irradiance(grid, &baked.lit.intersector, at.p, at.n, at.n, lookup).x) - double(truth[i].e.x);
      sum += e * e / double(probes.size());
    }
    return std::sqrt(std::max(0.0, sum - noise)) / (most - least);
  };
  const double rays = nrmse(guarded, Guard::rays);
  const double planes = nrmse(guarded, Guard::planes);
  const double off = nrmse(open, Guard::off);
  printf("NRMSE rays %.4f planes %.4f off %.4f\n", rays, planes, off);
  EXPECT_LE(rays, 0.032);
  EXPECT_LE(planes, 0.032);
  EXPECT_LE(rays, off);
  EXPECT_LE(planes, off);
  // A fit at the surface has a fifth less error: 0.79 to 0.83 of it, against 16,384 paths a point. What noise a quarter
  // of the paths leave in the truth moves that by 0.03.
  for (const Guard guard : {Guard::rays, Guard::planes})
    EXPECT_LE(nrmse(guarded, guard, Interpolation::fitted), 0.9 * rays) << name_of(guard);
}

// The stored variance predicts the spread of bakes that differ in their seed alone.
TEST(Variance, PredictsTheSpreadOfBakes) {
  const Baked baked("room_boxes.gltf");
  const std::vector<SurfacePoint> points = read_points("room_boxes_points.csv");
  constexpr int bakes = 24;
  std::vector<IrradianceGrid> grids;
  for (int seed = 0; seed < bakes; ++seed) {
    GridBakeParams params;
    params.resolution = V3i(12, 8, 10);
    params.photons = 30'000;
    params.seed = std::uint64_t(seed + 1);
    params.guard = Guard::off;
    grids.push_back(resolve(bake_grid_sums(baked.lit, params)));
  }
  double predicted = 0;
  double measured = 0;
  for (std::size_t i = 0; i < points.size(); i += 10) {
    double sum = 0;
    double squares = 0;
    for (const IrradianceGrid& grid : grids) {
      const Footprint f = lookup_footprint(grid, nullptr, points[i].p, points[i].n, {.guard = Guard::off});
      const double e = double(irradiance(grid, f, points[i].n, Reconstruction::optimal).x);
      const double se = double(irradiance_standard_error(grid, f).x);
      sum += e;
      squares += e * e;
      predicted += se * se / bakes;
    }
    measured += (squares - sum * sum / bakes) / (bakes - 1);
  }
  // The prediction takes neighbouring vertices as independent and a photon's bounces within a cell as
  // several photons (both down), and the light as spread over the hemisphere (either way): it is asked to
  // be right within a factor of two in variance.
  EXPECT_GT(predicted / measured, 0.5);
  EXPECT_LT(predicted / measured, 2.0);
  printf("predicted / measured variance %.2f\n", predicted / measured);
}

// A bake of less than a photon a vertex that goes on with more: which vertices are lit, and so their guard, is as it
// was.
TEST(GrowingBake, KeepsItsGuard) {
  const Baked baked("room_boxes.gltf");
  GridBakeParams params;
  params.resolution = V3i(16, 10, 14);
  params.photons = 1'000;
  GridAccumulator first = bake_grid_sums(baked.lit, params);
  params.pilot_for_photons = params.photons;
  params.photons = 20'000;
  params.photon_range = {{1'000, 20'000}};
  GridAccumulator more = bake_grid_sums(baked.lit, params);
  EXPECT_EQ(first.guard, more.guard);
  first.metadata["photons"] = more.metadata["photons"];
  std::vector<GridAccumulator> parts;
  parts.push_back(std::move(first));
  parts.push_back(std::move(more));
  EXPECT_EQ(merge(std::move(parts), {"first", "more"}).photon_end, 20'000U);
}

}  // namespace
}  // namespace ivory
