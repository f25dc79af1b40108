// ivory bench gaussians: one ball of light on a matt surface by cosine lobes and by spherical Gaussians, against the
// exact integral.
#include <cmath>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/lobe_table.h"
#include "tools/commands.h"
#include "tools/common.h"

namespace ivory {
namespace {

constexpr double pi_d = 3.14159265358979323846;

// E of a cap of radiance 1 around an axis `angle` from the normal, cut at the horizon: the midpoint rule, even in solid
// angle. The cut's kink leaves some 1e-5 of it.
double exact_irradiance(double half_angle, double angle) {
  constexpr int n = 600;
  const double height = 1 - std::cos(half_angle);
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double c = 1 - height * (i + 0.5) / n;
    const double s = std::sqrt(1 - c * c);
    for (int j = 0; j < n; ++j) {
      const double phi = 2 * pi_d * (j + 0.5) / n;
      sum += std::max(0.0, c * std::cos(angle) + s * std::cos(phi) * std::sin(angle));
    }
  }
  return sum / (double(n) * n) * 2 * pi_d * height;
}

// a exp(sharpness (axis.w - 1)).
struct Gaussian {
  double sharpness;
  double amplitude;
};

// The integral of the product of two with axes `angle` apart (Tsai & Shih 2006, eq. 3), scaled so that nothing
// overflows.
double product_integral(const Gaussian& a, const Gaussian& b, double angle) {
  const double l1 = a.sharpness;
  const double l2 = b.sharpness;
  const double length = std::sqrt(l1 * l1 + l2 * l2 + 2 * l1 * l2 * std::cos(angle));
  const double sinh_scaled = std::exp(length - l1 - l2) - std::exp(-length - l1 - l2);
  return a.amplitude * b.amplitude * 2 * pi_d * sinh_scaled / length;
}

// The Gaussian with a cap's solid angle and mean cosine, coth(l) - 1/l = (1 + cos(half angle))/2.
Gaussian cap_gaussian(double half_angle) {
  const double mean_cosine = (1 + std::cos(half_angle)) / 2;
  double low = 1e-3;
  double high = 1e8;
  for (int i = 0; i < 200; ++i) {
    const double middle = std::sqrt(low * high);
    (1 / std::tanh(middle) - 1 / middle < mean_cosine ? low : high) = middle;
  }
  return {low, (1 - std::cos(half_angle)) * low / (1 - std::exp(-2 * low))};
}

void run(const CommonOptions& common) {
  constexpr Gaussian cosine{2.133, 1.17};  // the clamped cosine as Hill's widely used single Gaussian
  const LobeTable table = make_lobe_table();
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  std::string text = "half angle  angle from the normal  exact E/L  lobes  Gaussians\n";
  for (const int half : {5, 15, 30, 60}) {
    const double half_rad = half * pi_d / 180;
    const Gaussian light = cap_gaussian(half_rad);
    for (int degrees = 0; degrees <= 120; degrees += 5) {
      const double angle = degrees * pi_d / 180;
      const V3f axis(float(std::sin(angle)), 0, float(std::cos(angle)));
      const double exact = exact_irradiance(half_rad, angle);
      if (degrees >= 90 + half) break;  // all of it is below the horizon
      const double lobes =
          double(lobe_product_integral(table, {V3f(0, 0, 1), 1, 1}, cap_lobe(axis, float(std::cos(half_rad)))));
      const double gaussians = product_integral(cosine, light, angle);
      rows.push_back({{"half_angle_deg", half},
                      {"angle_deg", degrees},
                      {"exact", exact},
                      {"lobes", lobes},
                      {"gaussians", gaussians}});
      text += fmt::format("{:>10}  {:>21}  {:>9.5f}  {:>+5.1f} %  {:>+7.1f} %\n", half, degrees, exact,
                          100 * (lobes / exact - 1), 100 * (gaussians / exact - 1));
    }
  }
  print_result(common, {{"rows", rows}}, text);
}

}  // namespace

void add_bench_gaussians_command(CLI::App& bench, CommonOptions& common) {
  CLI::App* command = bench.add_subcommand("gaussians",
                                           "An unshadowed ball of light on a matt surface by cosine lobes and by "
                                           "spherical Gaussians, against the integral.");
  command->footer("Example:\n  ivory bench gaussians --json");
  set_action(*command, common, Output::none, [&common] { run(common); });
}

}  // namespace ivory
