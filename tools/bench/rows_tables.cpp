// Rows without a scene: environments, FIV tables, lobes, and memory itself.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "grid/env/irradiance.h"
#include "grid/lobes/lobe.h"
#include "grid/lobes/table.h"
#include "tools/bench/measure_env.h"
#include "tools/bench/measure_row.h"
#include "tools/bench/measure_tracer.h"
#include "tools/stability/measure_fiv.h"
#include "tracer/core/sampler.h"
#include "tracer/core/sampling.h"

namespace ivory {
namespace {

constexpr int map_width = 4096;
constexpr int map_height = 2048;
constexpr double map_bytes = double(map_width) * map_height * sizeof(Rgb);
constexpr const char* one_pass = "one pass over the pixels";

BenchRow pass_row(const BenchAllParams& params) {
  const EnvironmentImage image = make_bench_environment(map_width, map_height);
  const std::vector<float> from(std::size_t(map_width) * map_height * 3, 1.0F);
  std::vector<float> to(from.size());
  double kept = 0;
  // A copy moves every byte twice, a pass once.
  return measure_row(
      params, {"", "bytes", "memory copied, of which half is read"}, map_bytes, [&] { kept += sum_pixels(image).x; },
      [&] { copy_bytes(from, to); });
}

BenchRow sh9_row(const BenchAllParams& params) {
  const EnvironmentImage image = make_bench_environment(map_width, map_height);
  double kept = 0;
  return measure_row(
      params, {"", "bytes", one_pass}, map_bytes, [&] { kept += radiance_moments(image).total.x; },
      [&] { kept += sum_pixels(image).x; });
}

BenchRow difmap_row(const BenchAllParams& params) {
  const EnvironmentImage image = make_bench_environment(map_width, map_height);
  double kept = 0;
  return measure_row(
      params, {"", "bytes", one_pass}, map_bytes,
      [&] { kept += double(bake_irradiance(make_irradiance_tree(image), 16).e.texels.front().x); },
      [&] { kept += sum_pixels(image).x; });
}

// Not a bound but what a table replaces: rays by the sample and direction, of which every 199th is shot.
BenchRow fiv_row(const BenchAllParams& params) {
  Scene scene = make_bench_scene(4000);
  scene.lights.clear();
  const FivOccluder occluder = make_fiv_occluder(scene);
  const CubeMap light = two_area_lights(32);
  FivParams fiv;
  fiv.samples = V3i(32, 17, 15);
  fiv.parts = 1;
  FivBakeTime time;
  return measure_seconds(
      params, {"", "sample directions", "one occlusion ray for each"},
      double(fiv.samples.x) * fiv.samples.y * fiv.samples.z * 6 * 32 * 32,
      [&] { return time.table_s * params.threads; },
      [&] {
        time = compare_with_rays(occluder, light, fiv, 199);
        return time.rays_s * params.threads;
      });
}

BenchRow lobe_row(const BenchAllParams& params) {
  const LobeTable table = make_lobe_table();
  RandomStream random(1, StreamPurpose::test, 0);
  std::vector<std::pair<Lobe, Lobe>> pairs(std::size_t(std::max(1.0, 100'000 * params.scale)));
  for (auto& [a, b] : pairs) {
    a = {sample_sphere(random.next2()), std::exp2(10 * random.next()), 1};
    b = {sample_sphere(random.next2()), std::exp2(10 * random.next()), 1};
  }
  std::vector<float> results(pairs.size());  // kept, so that the compiler keeps the work
  const tbb::blocked_range<std::size_t> blocks(0, pairs.size(), 4096);
  return measure_row(
      params, {"", "products", "both lobes evaluated in one direction"}, double(pairs.size()),
      [&] {
        tbb::parallel_for(blocks, [&](const auto& range) {
          for (std::size_t i = range.begin(); i < range.end(); ++i)
            results[i] = lobe_product_integral(table, pairs[i].first, pairs[i].second);
        });
      },
      [&] {
        const V3f w(0, 0, 1);
        tbb::parallel_for(blocks, [&](const auto& range) {
          for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const Lobe& a = pairs[i].first;
            const Lobe& b = pairs[i].second;
            results[i] = a.scale * std::pow(std::max(0.0F, a.axis.dot(w)), a.exponent) * b.scale *
                         std::pow(std::max(0.0F, b.axis.dot(w)), b.exponent);
          }
        });
      });
}

}  // namespace

std::vector<RowMaker> table_rows() {
  return {{"one pass over pixels", pass_row},
          {"SH9 projection", sh9_row},
          {"DifMap of 6x16x16", difmap_row},
          {"FIV bake", fiv_row},
          {"products of lobes", lobe_row}};
}

}  // namespace ivory
