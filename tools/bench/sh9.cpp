// ivory bench sh9: the projection onto nine harmonics beside merely adding up the same pixels.
#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/env/irradiance.h"
#include "tools/bench/measure_env.h"
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

void run_bench_sh9(const BenchSh9Options& options, const CommonOptions& common) {
  const EnvironmentImage image = make_bench_environment(options.size.x, options.size.y);
  const auto& pixels = std::get<EnvironmentMap>(image.map).radiance;

  std::vector<double> projection;
  std::vector<double> sum;
  double checksum = 0;  // used below, so that neither is optimised away
  for (int round = 0; round <= options.rounds; ++round) {
    const double sum_s = seconds_of([&] { checksum += sum_pixels(image).x; });
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
