// The directional bases against dense quadrature over the sphere.
#include "grid/field/basis.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "grid/base/error.h"

namespace ivory {
namespace {

// Directions spread evenly (Fibonacci spiral), equal weights 4 pi / N. Rotated by an odd
// angle so that none of them sits on a basis function's kink in a pattern.
std::vector<V3f> sphere_directions(int count) {
  std::vector<V3f> out;
  const double golden = 3.14159265358979 * (3 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count;
    const double r = std::sqrt(1 - z * z);
    out.emplace_back(float(r * std::cos(golden * i)), float(z), float(r * std::sin(golden * i)));
  }
  return out;
}

// Reconstruction is linear in the moments but for the clamps, so the response to a one-directional
// light of unit irradiance at w is the kernel that stands in for max(0, n.w).
struct KernelError {
  double mean_rms = 0;    // mean over normals of the RMS over directions
  double pooled_rms = 0;  // RMS over normals and directions together
  double worst = 0;
  double diagonal_uniform_bias = 0;
};

// The table speaks of the linear reconstruction; a single light is where the bracket clamps hardest
// (it makes LB exact), so the unclamped kernel is recovered by adding a strong uniform light, which
// moves the value away from both bounds, and subtracting its known response.
double kernel(Basis basis, Reconstruction reconstruction, const V3f& w, const V3f& n) {
  constexpr double uniform = 40;
  std::array<float, 36> moments{};
  const auto f = eval(basis, w);
  std::array<double, 12> background{};
  switch (basis) {  // integral of each function over the sphere
    case Basis::vectors:
      background = {0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 2};
      break;
    case Basis::vectors9:
      background = {0, 0, 0, 2, 2, 2, 0, 0, 0, 0, 0, 0};
      break;
    case Basis::ambient_cube:
      background = {1, 1, 1, 1, 1, 1};
      break;
    case Basis::sh9:
    case Basis::sh4:
      background = {4 * std::sqrt(1 / (4 * 3.14159265358979))};
      break;
  }
  for (std::size_t i = 0; i < std::size_t(function_count(basis)); ++i) {
    moments[3 * i] = float(f[i] + uniform * 3.14159265358979 * background[i]);
  }
  const double with_light = irradiance(basis, reconstruction, moments.data(), n).x;
  for (std::size_t i = 0; i < std::size_t(function_count(basis)); ++i) {
    moments[3 * i] = float(uniform * 3.14159265358979 * background[i]);
  }
  return with_light - irradiance(basis, reconstruction, moments.data(), n).x;
}

KernelError measure(Basis basis, Reconstruction reconstruction) {
  const auto lights = sphere_directions(4001);
  const auto normals = sphere_directions(997);
  KernelError error;
  double pooled = 0;
  for (const V3f& n : normals) {
    double sum = 0;
    for (const V3f& w : lights) {
      const double e = kernel(basis, reconstruction, w, n) - std::max(0.0F, n.dot(w));
      sum += e * e;
      error.worst = std::max(error.worst, std::abs(e));
    }
    error.mean_rms += std::sqrt(sum / double(lights.size())) / double(normals.size());
    pooled += sum / double(lights.size());
  }
  error.pooled_rms = std::sqrt(pooled / double(normals.size()));
  const V3f diagonal = V3f(1, 1, 1).normalized();
  double uniform = 0;
  for (const V3f& w : lights) uniform += kernel(basis, reconstruction, w, diagonal);
  error.diagonal_uniform_bias = uniform * 4 / double(lights.size()) - 1;
  return error;
}

struct TableRow {
  Basis basis;
  Reconstruction reconstruction;
  double mean_rms;
  double worst;
  double worst_rounding;  // half a unit of the last digit that the published figure has
  double bias;
};

// Tolerance 1 %: the quadrature is good to 0.1 %, the published RMS figures are rounded to 0.5 %.
TEST(Basis, DirectionalErrorTable) {
  const std::vector<TableRow> table{
      {Basis::vectors, Reconstruction::paper, 0.096, 0.385, 0.0005, 1 / std::sqrt(3.0) - 1},
      {Basis::vectors, Reconstruction::optimal, 0.0575, 0.26, 0.005, 0},
      {Basis::vectors9, Reconstruction::optimal, 0.0596, 0.26, 0.005, 0},
      {Basis::sh9, Reconstruction::optimal, 0.0361, 0.094, 0.0005, 0},
      {Basis::ambient_cube, Reconstruction::optimal, 0.1446, 0.42, 0.005, 0},
      {Basis::sh4, Reconstruction::optimal, 0.1443, 0.25, 0.005, 0},
  };
  for (const TableRow& row : table) {
    SCOPED_TRACE(std::string(name_of(row.basis)) + " " + std::string(name_of(row.reconstruction)));
    const KernelError error = measure(row.basis, row.reconstruction);
    EXPECT_NEAR(error.mean_rms, row.mean_rms, 0.01 * row.mean_rms);
    EXPECT_NEAR(error.worst, row.worst, 0.01 * row.worst + row.worst_rounding);
    EXPECT_NEAR(error.diagonal_uniform_bias, row.bias, 0.005);
    printf("%-13s %-8s mean rms %.4f pooled rms %.4f worst %.4f diagonal bias %+.4f\n",
           std::string(name_of(row.basis)).c_str(), std::string(name_of(row.reconstruction)).c_str(), error.mean_rms,
           error.pooled_rms, error.worst, error.diagonal_uniform_bias);
  }
}

// The pooled RMS of the ambient cube has a closed form. With g(a.b) = mean of max(0, a.w) max(0, b.w)
// = (sin t + (pi - t) cos t) / (6 pi), t the angle between a and b:
//   kernel      mean k^2  = 1/6,
//   cube        mean k'^2 = 3 <n_x^4> / 6 + 6 <n_x^2 n_y^2> g(0) = 1/10 + (2/5) / (6 pi),
//   product     mean k k' = 3 <n_x^2 g(|n_x|)>, |n_x| uniform in [0, 1].
TEST(Basis, AmbientCubePooledErrorClosedForm) {
  const double p = 3.14159265358979;
  const double own = 0.1 + 0.4 / (6 * p);
  const double product = (p / 16 + p / 8 + p / 8 - 3 * p / 64) / (2 * p);
  const double expected = std::sqrt(own + 1.0 / 6 - 2 * product);
  EXPECT_NEAR(measure(Basis::ambient_cube, Reconstruction::optimal).pooled_rms, expected, 2e-3 * expected);
}

// Random lights: moments of a few point-like sources of random colour.
std::array<float, 36> random_moments(std::mt19937& generator, int lights, std::vector<std::pair<V3f, Rgb>>& out) {
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform;
  std::array<float, 36> moments{};
  out.clear();
  for (int i = 0; i < lights; ++i) {
    const V3f w = V3f(normal(generator), normal(generator), normal(generator)).normalized();
    const Rgb radiance(uniform(generator), uniform(generator), uniform(generator));
    out.emplace_back(w, radiance);
    const auto f = eval(Basis::vectors, w);
    for (std::size_t k = 0; k < 12; ++k) {
      for (unsigned c = 0; c < 3; ++c) moments[3 * k + c] += f[k] * radiance[c];
    }
  }
  return moments;
}

TEST(Basis, BracketHoldsAndIsExactForOneLight) {
  std::mt19937 generator(7);
  std::vector<std::pair<V3f, Rgb>> lights;
  for (int trial = 0; trial < 2000; ++trial) {
    const auto moments = random_moments(generator, 1 + trial % 7, lights);
    std::normal_distribution<float> normal;
    const V3f n = V3f(normal(generator), normal(generator), normal(generator)).normalized();
    Rgb truth(0, 0, 0);
    for (const auto& [w, radiance] : lights) truth += radiance * std::max(0.0F, n.dot(w));
    const IrradianceBracket bracket = irradiance_bracket(moments.data(), n);
    const Rgb value = irradiance(Basis::vectors, Reconstruction::optimal, moments.data(), n);
    for (unsigned c = 0; c < 3; ++c) {
      constexpr float rounding = 1e-5F;  // a few float operations on sums of at most seven unit lights
      EXPECT_GE(truth[c], bracket.lower[c] - rounding);
      EXPECT_LE(truth[c], bracket.upper[c] + rounding);
      EXPECT_GE(value[c], bracket.lower[c] - rounding);
      EXPECT_LE(value[c], bracket.upper[c] + rounding);
      if (lights.size() == 1) {
        EXPECT_NEAR(bracket.lower[c], truth[c], rounding);
      }
    }
  }
}

TEST(Basis, UniformLightIsExactForEveryNormal) {
  for (const Basis basis : all_bases) {
    std::array<float, 36> moments{};
    const auto lights = sphere_directions(20000);
    std::array<double, 12> sums{};
    for (const V3f& w : lights) {
      const auto f = eval(basis, w);
      for (std::size_t k = 0; k < 12; ++k) sums[k] += 4 * 3.14159265358979 / 20000 * f[k];
    }
    for (std::size_t k = 0; k < 12; ++k) moments[3 * k] = float(sums[k]);
    for (const V3f& n : sphere_directions(200)) {
      // 20,000 directions integrate the kinked functions to about 1e-3.
      EXPECT_NEAR(irradiance(basis, Reconstruction::optimal, moments.data(), n).x, pi, 3e-3) << name_of(basis);
    }
  }
}

TEST(Basis, HemispheresRoundTrip) {
  std::mt19937 generator(3);
  std::vector<std::pair<V3f, Rgb>> lights;
  const auto moments = random_moments(generator, 5, lights);
  const auto hemispheres = hemispheres_from_moments(moments);
  for (std::size_t delta = 0; delta < 6; ++delta) {
    std::array<float, 9> expected{};
    for (const auto& [w, radiance] : lights) {
      const bool positive = delta % 2 == 0;
      if ((w[unsigned(delta / 2)] >= 0) != positive) continue;
      for (unsigned i = 0; i < 3; ++i) {
        for (unsigned c = 0; c < 3; ++c) expected[3 * i + c] += w[i] * radiance[c];
      }
    }
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(hemispheres[9 * delta + i], expected[i], 1e-5F);
  }
  const auto back = moments_from_hemispheres(hemispheres);
  for (std::size_t i = 0; i < 36; ++i) EXPECT_NEAR(back[i], moments[i], 1e-5F);
}

TEST(Basis, PaperReconstructionIsForVectorsOnly) {
  const std::array<float, 36> moments{};
  EXPECT_THROW(irradiance(Basis::sh9, Reconstruction::paper, moments.data(), V3f(0, 1, 0)), ParameterError);
  EXPECT_THROW(from_name<Basis>("sh2"), ParameterError);
}

}  // namespace
}  // namespace ivory
