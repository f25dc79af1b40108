// ivory bench gaussians: one spherical light on a matt surface by cosine lobes and by spherical Gaussians, against the
// exact integral.
#include "tools/stability/gaussians.h"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/lobes/table.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/stability/scenes.h"

namespace ivory {
namespace {

void run(const CommonOptions& common) {
  const LobeTable table = make_lobe_table();
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  std::string text = "half angle  angle from the normal  exact E/L  lobes  Gaussian cosine  fitted Gaussians\n";
  for (const int half : {5, 15, 30, 60}) {
    const double half_rad = half * pi_d / 180;
    const SphericalGaussian light = cap_gaussian(half_rad);
    for (int degrees = 0; degrees <= 120; degrees += 5) {
      const double angle = degrees * pi_d / 180;
      const V3f axis(float(std::sin(angle)), 0, float(std::cos(angle)));
      const double exact = ball_irradiance(std::cos(angle), std::pow(std::sin(half_rad), 2));
      if (degrees >= 90 + half) break;  // all of it is below the horizon
      const double lobes =
          double(lobe_product_integral(table, {V3f(0, 0, 1), 1, 1}, cap_lobe(axis, float(std::cos(half_rad)))));
      const double gaussians = irradiance_by_cosine_gaussian(light, std::cos(angle));
      const double fitted = irradiance_by_fit(light, std::cos(angle));
      rows.push_back({{"half_angle_deg", half},
                      {"angle_deg", degrees},
                      {"exact", exact},
                      {"lobes", lobes},
                      {"gaussians", gaussians},
                      {"gaussians_fitted", fitted}});
      text += fmt::format("{:>10}  {:>21}  {:>9.5f}  {:>+5.1f} %  {:>+13.1f} %  {:>+14.1f} %\n", half, degrees, exact,
                          100 * (lobes / exact - 1), 100 * (gaussians / exact - 1), 100 * (fitted / exact - 1));
    }
  }
  print_result(common, {{"rows", rows}}, text);
}

}  // namespace

void add_bench_gaussians_command(Command bench, CommonOptions& common) {
  Command command = bench.add_subcommand("gaussians",
                                         "An unshadowed spherical light on a matt surface by cosine lobes and by "
                                         "spherical Gaussians, against the integral.");
  command.footer(
      "The ball as the Gaussian of its flux and mean cosine; its irradiance by a single Gaussian for the cosine\n"
      "(\"gaussians\" with --json) and by Hill's fit (\"gaussians_fitted\").\n"
      "\nExample:\n"
      "  ivory bench gaussians --json");
  set_action(command, common, Output::none, [&common] { run(common); });
}

}  // namespace ivory
