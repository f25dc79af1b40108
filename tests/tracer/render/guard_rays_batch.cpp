// Look-ups of many points of a scene at once beside those one by one, by every guard.
#include "tracer/render/guard_rays_batch.h"

#include <cstring>

#include <gtest/gtest.h>

#include "grid/field/resolve.h"
#include "tests/support/paths.h"
#include "tracer/bake/field/baker.h"
#include "tracer/core/sampler.h"
#include "tracer/gltf/loader.h"
#include "tracer/render/guard_rays.h"

namespace ivory {
namespace {

bool same_bits(const Rgb& a, const Rgb& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// On surfaces, in narrow gaps and in corners, and anywhere in space: at every eighth place, whose normal is 0 or any.
TEST(BatchedGuardRays, AnswerWhatRaysOneByOneDo) {
  const LitScene lit = make_lit_scene(load_gltf(std::string(source_folder) + "/scenes/two_rooms.gltf", {}).scene);
  std::vector<V3f> p;
  std::vector<V3f> ng;
  std::vector<V3f> n;
  RandomStream random(1, StreamPurpose::test, 0);
  const Box3f box = bounds(*lit.scene);
  const auto anywhere = [&] { return box.min + box.size() * V3f(random.next(), random.next(), random.next()); };
  while (p.size() < 3001) {
    const V3f from = anywhere();
    const V3f direction = (anywhere() - from).normalized();
    const auto hit = lit.intersector.closest({.origin = from, .direction = direction});
    if (!hit) continue;
    const bool in_space = p.size() % 8 == 0;
    p.push_back(in_space ? from : from + direction * hit->t);
    n.push_back(hit->ng.dot(direction) < 0 ? hit->ng : -hit->ng);
    ng.push_back(in_space && p.size() % 16 == 1 ? V3f(0, 0, 0) : n.back());
  }
  for (const int levels : {1, 3}) {
    GridBakeParams bake;
    bake.resolution = V3i(20, 12, 20);
    bake.photons = 20'000;
    bake.levels = levels;
    const IrradianceGrid grid = resolve(bake_grid_sums(lit, bake));
    ASSERT_EQ(grid.levels(), levels);
    for (const Guard guard : values_of<Guard>()) {
      for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::fitted}) {
        const LookupParams params{.guard = guard, .interpolation = interpolation};
        const auto e = lookup_irradiance(grid, &lit.intersector, {p, ng}, n, params);
        const auto readings = lookup_readings(grid, &lit.intersector, {p, ng}, n, params, 0.1F);
        for (std::size_t i = 0; i < p.size(); ++i) {
          const Footprint footprint = lookup_footprint(grid, &lit.intersector, p[i], ng[i], params);
          ASSERT_TRUE(same_bits(e[i], irradiance(grid, footprint, n[i], params.reconstruction)))
              << i << " " << name_of(guard) << " " << name_of(interpolation) << levels;
          ASSERT_TRUE(same_bits(readings[i].e, e[i]));
          ASSERT_TRUE(same_bits(readings[i].standard_error, irradiance_standard_error(grid, footprint, 0.1F)));
          ASSERT_EQ(readings[i].seen, footprint.count > 0);
        }
      }
    }
  }
}

}  // namespace
}  // namespace ivory
