#include "tracer/render/probe.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "tracer/render/path_tracer.h"

namespace ivory {

namespace {

ProbeResult probe_point(const LitScene& lit, const ProbePoint& point, const ProbeParams& params, std::uint64_t index) {
  const Surface white = white_receiver(lit, point.p, point.n);
  PathParams path;
  path.max_bounces = params.max_bounces + 1;
  path.indirect_only = params.indirect_only;
  path.strategy = params.strategy;

  RandomStream random(params.seed, StreamPurpose::probe, index);
  // Welford's running mean and squared deviations, in double.
  double mean[3] = {0, 0, 0};
  double deviations[3] = {0, 0, 0};
  for (int i = 0; i < params.samples; ++i) {
    const Rgb e = trace_scattered(lit, white, point.n, path, random) * pi;
    for (int c = 0; c < 3; ++c) {
      const double delta = double(e[c]) - mean[c];
      mean[c] += delta / (i + 1);
      deviations[c] += delta * (double(e[c]) - mean[c]);
    }
  }
  ProbeResult result;
  const double n = params.samples;
  for (int c = 0; c < 3; ++c) {
    result.e[c] = float(mean[c]);
    result.standard_error[c] = params.samples > 1 ? float(std::sqrt(deviations[c] / (n * (n - 1)))) : 0.0F;
  }
  return result;
}

}  // namespace

Surface white_receiver(const LitScene& lit, const V3f& p, const V3f& n) {
  Surface white;
  white.p = p;
  white.ng = n;
  white.ns = n;
  white.diffuse_albedo = Rgb(1, 1, 1);
  white.specular_f0 = Rgb(0, 0, 0);
  white.specular_f90 = Rgb(0, 0, 0);
  white.emission = Rgb(0, 0, 0);
  white.reach_m = own_surface_reach_m(lit.intersector, p, n);
  return white;
}

std::vector<ProbeResult> probe_scene(const LitScene& lit, const std::vector<ProbePoint>& points,
                                     const ProbeParams& params) {
  std::vector<ProbeResult> results(points.size());
  std::atomic<std::size_t> done{0};
  tbb::task_arena arena(params.threads > 0 ? params.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
      results[i] = probe_point(lit, points[i], params, i);
      const std::size_t finished = ++done;
      if (params.progress) params.progress(double(finished) / double(points.size()));
    });
  });
  return results;
}

}  // namespace ivory
