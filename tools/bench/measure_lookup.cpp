#include "tools/bench/measure_lookup.h"

#include <vector>

#include <time.h>

#include "grid/base/error.h"
#include "tools/bench/median.h"
#include "tracer/core/sampler.h"
#include "tracer/core/surface.h"
#include "tracer/render/guard_rays.h"
#include "tracer/render/guard_rays_batch.h"

namespace ivory {
namespace {

// The thread's own time, so that other work on the machine does not count.
double thread_time_ns() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) * 1e9 + double(now.tv_nsec);
}

template <typename Work>
double median_ns(int rounds, std::size_t count, const Work& work) {
  std::vector<double> times;
  for (int round = 0; round < rounds; ++round) {
    const double start = thread_time_ns();
    work();
    times.push_back((thread_time_ns() - start) / double(count));
  }
  return median(times);
}

}  // namespace

SurfacePoints surface_points(const GridFrame& frame, const Intersector& intersector, int count) {
  SurfacePoints points;
  RandomStream random(1, StreamPurpose::test, 0);
  for (int tries = 0; points.p.size() < std::size_t(count) && tries < 100 * count; ++tries) {
    const V3f a(random.next(), random.next(), random.next());
    const V3f b(random.next(), random.next(), random.next());
    const V3f from = frame.to_world(a * V3f(frame.size) - V3f(0.5F, 0.5F, 0.5F));
    const V3f to = frame.to_world(b * V3f(frame.size) - V3f(0.5F, 0.5F, 0.5F));
    const V3f direction = (to - from).normalized();
    const auto hit = intersector.closest({.origin = from, .direction = direction});
    if (!hit) continue;
    points.p.push_back(from + direction * hit->t);
    points.n.push_back(hit->ng.dot(direction) < 0 ? hit->ng : -hit->ng);
  }
  return points;
}

LookupBench bench_lookup(const IrradianceGrid& grid, const Intersector& intersector, const LookupParams& lookup,
                         int lookups, int rounds) {
  const SurfacePoints points = surface_points(grid.frame, intersector, lookups);
  const std::size_t count = points.p.size();
  if (count == 0)
    throw Error(intersector.scene().name, "no surface was found inside the grid", "give the scene that was baked");
  // The results are kept, so that the compiler keeps the work.
  std::vector<Rgb> results(count);
  const auto look_up = [&](Guard guard) {
    LookupParams params = lookup;
    params.guard = guard;
    // In turn, so that what else the machine does comes to both.
    std::vector<double> single;
    std::vector<double> batched;
    for (int round = 0; round < rounds; ++round) {
      single.push_back(median_ns(1, count, [&] {
        for (std::size_t i = 0; i < count; ++i)
          results[i] = lookup_irradiance(grid, &intersector, points.p[i], points.n[i], points.n[i], params);
      }));
      batched.push_back(median_ns(1, count, [&] {
        results = lookup_irradiance(grid, &intersector, {points.p, points.n}, points.n, params);
      }));
    }
    return LookupFigure{median(single), median(batched)};
  };
  LookupBench bench;
  bench.off = look_up(Guard::off);
  bench.planes = look_up(Guard::planes);
  bench.rays = look_up(Guard::rays);
  const float voxel_m = grid.finest_frame().spacing_m.x;
  bench.occlusion_ray_ns = median_ns(rounds, count, [&] {
    for (std::size_t i = 0; i < count; ++i) {
      results[i].x = intersector.transmittance(
          {.origin = offset_origin(points.p[i], points.n[i], points.n[i]), .direction = points.n[i], .t_max = voxel_m});
    }
  });
  return bench;
}

}  // namespace ivory
