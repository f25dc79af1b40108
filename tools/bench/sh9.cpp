// ivory bench sh9: the projection onto nine harmonics beside merely adding up the same pixels.
#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>

#include "grid/env/irradiance.h"
#include "tools/bench/median.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"

namespace ivory {

namespace {

struct BenchSh9Options {
  Imath::V2i size{4096, 2048};
  int rounds = 15;
};

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// What any method has to do at least: read every pixel once and add it up in double, on the same threads.
V3d sum_pixels(const std::vector<Rgb>& pixels) {
  constexpr std::size_t chunks = 64;
  constexpr std::size_t lanes = 12;
  std::array<V3d, chunks> parts;
  tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t chunk) {
    const std::size_t begin = pixels.size() * chunk / chunks;
    const std::size_t end = pixels.size() * (chunk + 1) / chunks;
    const float* const values = &pixels[begin].x;
    const std::size_t count = 3 * (end - begin);
    double sums[lanes] = {};
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes)
      for (std::size_t k = 0; k < lanes; ++k) sums[k] += double(values[i + k]);
    for (std::size_t k = 0; i < count; ++i, ++k) sums[k] += double(values[i]);
    V3d& part = parts[chunk];
    part = V3d(0, 0, 0);
    for (std::size_t k = 0; k < lanes; ++k) part[int(k % 3)] += sums[k];
  });
  V3d sum(0, 0, 0);
  for (const V3d& part : parts) sum += part;
  return sum;
}

void run_bench_sh9(const BenchSh9Options& options, const CommonOptions& common) {
  EnvironmentMap map{options.size.x, options.size.y, {}};
  map.radiance.reserve(std::size_t(map.width) * std::size_t(map.height));
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column)
      map.radiance.emplace_back(float(1 + row % 17), float(1 + column % 13), float(1 + (row ^ column) % 11));
  }
  const EnvironmentImage image{EnvironmentLayout::latlong, std::move(map)};
  const auto& pixels = std::get<EnvironmentMap>(image.map).radiance;

  std::vector<double> projection;
  std::vector<double> sum;
  double checksum = 0;  // used below, so that neither is optimised away
  for (int round = 0; round <= options.rounds; ++round) {
    const double sum_s = seconds_of([&] { checksum += sum_pixels(pixels).x; });
    const double projection_s = seconds_of([&] { checksum += radiance_moments(image).total.x; });
    if (round == 0) continue;  // warms up
    sum.push_back(sum_s);
    projection.push_back(projection_s);
  }
  const double ratio = median(projection) / median(sum);
  const double gigabytes = double(pixels.size()) * sizeof(Rgb) / 1e9;
  print_result(
      common,
      {{"width", options.size.x},
       {"height", options.size.y},
       {"threads", thread_count(common)},
       {"projection_s", median(projection)},
       {"sum_s", median(sum)},
       {"ratio", ratio},
       {"projection_gb_per_s", gigabytes / median(projection)},
       {"sum_gb_per_s", gigabytes / median(sum)},
       {"checksum", checksum}},
      fmt::format("{} x {} pixels on {} threads: nine coefficients {:.2f} ms ({:.1f} GB/s), adding the pixels up "
                  "{:.2f} ms ({:.1f} GB/s), ratio {:.2f}\n",
                  options.size.x, options.size.y, thread_count(common), 1e3 * median(projection),
                  gigabytes / median(projection), 1e3 * median(sum), gigabytes / median(sum), ratio));
}

}  // namespace

void add_bench_sh9_command(Command bench, CommonOptions& common) {
  Command command = bench.add_subcommand(
      "sh9", "Time to project a lat-long map onto nine harmonics over the time to add up its pixels once");
  auto options = std::make_shared<BenchSh9Options>();
  command.add_image_size("--size", options->size, "Size of the map in pixels");
  command.add_option("--rounds", options->rounds, "Measurements in turn; medians are reported").within(1, 1000);
  command.footer("Example:\n  ivory bench sh9 --size 4096x2048 --threads 2");
  set_action(command, common, Output::none, [options, &common] { run_bench_sh9(*options, common); });
}

}  // namespace ivory
