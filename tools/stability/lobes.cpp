// Products of cosine lobes where they are least like lobes: exponents near 0, and lights that sink below the horizon.
#include <algorithm>
#include <cmath>

#include "grid/lobes/moments.h"
#include "grid/lobes/table.h"
#include "tools/stability/gaussians.h"
#include "tools/stability/scenes.h"
#include "tools/stability/stability.h"

namespace ivory {
namespace {

// Of a lobe: cos^e has (e + 1)/(e + 2).
double mean_cosine(double exponent) { return (exponent + 1) / (exponent + 2); }

// Integral of w times the product, the first axis being x, the other in the plane of x and y.
V3d vector_moment(const LobeProductMoments& m) {
  const double integral = std::exp(m.log_integral);
  if (!(integral > 0)) return {0, 0, 0};  // lobes that do not meet have no direction
  return V3d(std::cos(m.axis_angle_rad), std::sin(m.axis_angle_rad), 0) * (integral * mean_cosine(m.exponent));
}

std::vector<StabilityPoint> lobe_exponents(const StabilityParams& params) {
  const LobeTable table = make_lobe_table();
  std::vector<StabilityPoint> points;
  for (const double e1 : {0.0, 1e-3, 1e-2, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0}) {
    double by_table = 0;
    double moment = 0;
    double by_gaussians = 0;
    for (const double e2 : {0.0, 0.02, 0.2, 1.0, 4.0, 30.0, 1000.0}) {
      const V3d facing = vector_moment(lobe_product_moments(e1, e2, 0));
      const double largest = std::exp(lobe_product_moments(e1, e2, 0).log_integral);
      const int angles = params.quick ? 40 : 400;
      for (int i = 0; i < angles; ++i) {
        const double alpha = pi_d * (i + 0.31) / angles;
        const LobeProductMoments exact = lobe_product_moments(e1, e2, alpha);
        const double truth = std::exp(exact.log_integral);
        const Lobe a{V3f(1, 0, 0), float(e1), 1};
        const Lobe b{V3f(float(std::cos(alpha)), float(std::sin(alpha)), 0), float(e2), 1};
        by_table = std::max(by_table, std::abs(double(lobe_product_integral(table, a, b)) - truth) / largest);
        const Lobe product = lobe_product(table, a, b);
        const double length = double(lobe_integral(product)) * mean_cosine(double(product.exponent));
        moment = std::max(moment, (V3d(product.axis) * length - vector_moment(exact)).length() / facing.length());
        by_gaussians = std::max(by_gaussians, std::abs(gaussian_product(e1, e2, alpha) - truth) / largest);
      }
    }
    // The table's interpolation error, largest where the lobes part. The report's tables are 50 % off there.
    points.push_back({"one lobe, by table", e1, by_table, 0.002});
    points.push_back({"its direction and width: vector moment", e1, moment, 0.002});
    points.push_back({"spherical Gaussians", e1, by_gaussians, {}});
  }
  return points;
}

// A matt surface, a lobe of exponent 1, under a spherical light of half-angle 20 degrees that sinks below its horizon.
std::vector<StabilityPoint> lobe_horizon(const StabilityParams&) {
  const LobeTable table = make_lobe_table();
  const double half_angle = 20 * pi_d / 180;
  const double sine2 = std::pow(std::sin(half_angle), 2);
  const double facing = pi_d * sine2;
  std::vector<StabilityPoint> points;
  for (int step = 0; step <= 24; ++step) {
    const double elevation = 90 - 115.0 * step / 24;
    const double e = elevation * pi_d / 180;
    const double truth = ball_irradiance(std::sin(e), sine2);
    const Lobe matt{V3f(0, 1, 0), 1, 1};
    const Lobe light = cap_lobe(V3f(V3d(std::cos(e), std::sin(e), 0)), float(std::cos(half_angle)));
    const auto by_lobes = double(lobe_product_integral(table, matt, light));
    // A lobe's edge is soft where the ball's is hard.
    points.push_back({"lobes", elevation, std::abs(by_lobes - truth) / facing, 0.007});
    points.push_back(
        {"cosine of the centre", elevation, std::abs(facing * std::max(0.0, std::sin(e)) - truth) / facing, {}});
  }
  return points;
}

}  // namespace

std::vector<StabilityCase> stability_lobe_cases() {
  return {
      {.name = "lobe_exponents",
       .title = "Products of lobes with exponents near 0",
       .sentence = "Lobes of small exponents are hemispheres with an edge, which Gaussians in their stead miss by as "
                   "much as there is; "
                   "the lobes' table, exact in integral and direction, stays within two tenths of a per cent.",
       .x_label = "exponent",
       .y_label = "worst error of the product's integral / at angle 0",
       .log_x = true,
       .run = lobe_exponents},
      {.name = "lobe_horizon",
       .title = "Lobes of a light that sinks below the horizon",
       .sentence = "While a light sinks below a receiver's horizon lobes are off by half a per cent of the light seen "
                   "squarely, "
                   "which is several per cent of what is left of it: take shadow rays where that shows.",
       .x_label = "elevation of the light's centre, degrees",
       .y_label = "error / E seen squarely",
       .log_y = false,
       .run = lobe_horizon},
  };
}

}  // namespace ivory
