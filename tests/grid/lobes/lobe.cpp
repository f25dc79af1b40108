// Cosine lobes and their products, against closed forms and brute-force quadrature over the sphere.
#include "grid/lobes/lobe.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/lobes/moments.h"
#include "grid/lobes/table.h"

namespace ivory {
namespace {

constexpr double pi_d = std::numbers::pi;

const LobeTable& table() {
  static const LobeTable built = make_lobe_table();
  return built;
}

V3f in_plane(double angle_rad) { return V3f(float(std::cos(angle_rad)), float(std::sin(angle_rad)), 0); }

TEST(LobeMoments, HemispheresMeetInALune) {
  for (const double alpha : {0.0, 0.1, 1.0, 2.0, 3.0, 3.14})
    EXPECT_NEAR(std::exp(lobe_product_moments(0, 0, alpha).log_integral), 2 * (pi_d - alpha), 1e-12);
}

TEST(LobeMoments, SameAxisAddsExponents) {
  for (const double e1 : {0.0, 0.3, 7.0, 1234.5, 100000.0}) {
    for (const double e2 : {0.0, 1.0, 77.0, 100000.0}) {
      const LobeProductMoments m = lobe_product_moments(e1, e2, 0);
      EXPECT_NEAR(std::exp(m.log_integral) * (e1 + e2 + 1) / (2 * pi_d), 1, 1e-11);
      EXPECT_NEAR(m.axis_angle_rad, 0, 1e-12);
      EXPECT_NEAR(m.exponent / (e1 + e2 + 1), (e1 + e2) / (e1 + e2 + 1), 1e-7);
    }
  }
}

// For exponents that differ by 1 the hypergeometric factor of the closed form is 1:
// I = sqrt(pi) Gamma(N/2 + 1)/Gamma((N + 3)/2) |a1 + a2|^(N+1) B(e1 + 1, e2 + 1).
TEST(LobeMoments, ExponentsOneApartHaveAClosedForm) {
  for (const double e : {0.0, 0.5, 3.0, 40.0, 200.0}) {
    for (const double alpha : {0.01, 0.7, 1.5, 2.5, 3.1}) {
      const double n = 2 * e + 1;
      const double log_w = 0.5 * std::log(pi_d) + std::lgamma(n / 2 + 1) - std::lgamma((n + 3) / 2);
      const double log_b = std::lgamma(e + 1) + std::lgamma(e + 2) - std::lgamma(n + 2);
      const double expected = log_w + (n + 1) * std::log(2 * std::cos(alpha / 2)) + log_b;
      EXPECT_NEAR(lobe_product_moments(e, e + 1, alpha).log_integral, expected, 1e-10 * (1 + std::abs(expected)));
      EXPECT_NEAR(lobe_product_moments(e + 1, e, alpha).log_integral, expected, 1e-10 * (1 + std::abs(expected)));
    }
  }
}

TEST(LobeMoments, AgreeWithQuadratureOverTheSphere) {
  constexpr int steps = 1500;  // mid-point rule; 2e-5 at the hemispheres' edges for the smallest exponents
  for (const auto& [e1, e2, alpha] :
       {std::array{0.4, 2.0, 1.3}, {3.0, 60.0, 0.8}, {12.0, 12.0, 1.9}, {1.0, 30.0, 1.7}}) {
    double sum = 0, x = 0, y = 0;
    for (int i = 0; i < steps; ++i) {
      const double z = -1 + 2 * (i + 0.5) / steps;
      const double r = std::sqrt(1 - z * z);
      for (int j = 0; j < steps; ++j) {
        const double phi = 2 * pi_d * (j + 0.5) / steps;
        const double c1 = r * std::cos(phi);
        const double c2 = r * std::cos(phi - alpha);
        if (!(c1 > 0 && c2 > 0)) continue;
        const double f = std::pow(c1, e1) * std::pow(c2, e2) * 4 * pi_d / (double(steps) * steps);
        sum += f;
        x += f * c1;
        y += f * r * std::sin(phi);
      }
    }
    const LobeProductMoments m = lobe_product_moments(e1, e2, alpha);
    EXPECT_NEAR(std::exp(m.log_integral) / sum, 1, 1e-4);
    EXPECT_NEAR(m.axis_angle_rad, std::atan2(y, x), 1e-4);
    EXPECT_NEAR(m.exponent + 2, 1 / (1 - std::hypot(x, y) / sum), 1e-3 * (m.exponent + 2));
  }
}

// The report's table: mean 7.1e-4, worst 0.5. What is asked here is what the README states.
TEST(LobeTable, IntegralsAreWithinTheStatedErrors) {
  const LobeTableErrors errors = lobe_table_errors(table(), 20'000, 7);
  EXPECT_LT(errors.absolute.mean, 5e-5);
  EXPECT_LT(errors.absolute.worst, 1e-2);
  EXPECT_LT(errors.of_true.mean, 2e-4);
  EXPECT_LT(errors.of_true.worst, 5e-3);
  EXPECT_LT(errors.exponent.worst, 5e-3);
  EXPECT_LT(errors.axis.worst, 5e-3);
  EXPECT_LT(table().bytes(), 10'000'000U);
}

// Where interpolation would be worst by design: exponents under 1, angles around the right angle.
TEST(LobeTable, HoldsWhereTheReportsTableFails) {
  double worst = 0;
  for (double e1 = 0; e1 <= 1; e1 += 0.0625) {
    for (double e2 = 0; e2 <= 1; e2 += 0.0625) {
      for (double alpha = 1.2; alpha <= 2; alpha += 0.05) {
        const double truth = std::exp(lobe_product_moments(e1, e2, alpha).log_integral);
        const float found =
            lobe_product_integral(table(), {in_plane(0), float(e1), 1}, {in_plane(alpha), float(e2), 1});
        worst = std::max(worst, std::abs(double(found) / truth - 1));
      }
    }
  }
  EXPECT_LT(worst, 3e-3);
}

TEST(LobeTable, ProductDoesNotDependOnOrderOrFrame) {
  for (int i = 0; i < 200; ++i) {
    const V3f a = V3f(std::sin(float(i)), std::cos(2.3F * float(i)), std::sin(1.7F * float(i) + 1)).normalized();
    const V3f b = V3f(std::cos(0.3F * float(i)), std::sin(3.1F * float(i)), 0.7F).normalized();
    const Lobe p{a, float(i % 13), 2};
    const Lobe q{b, float((i * i) % 301), 0.5F};
    const Lobe pq = lobe_product(table(), p, q);
    const Lobe qp = lobe_product(table(), q, p);
    const float integral = lobe_product_integral(table(), p, q);
    // Floats, in a different order: 1e-5 is some hundred roundings.
    EXPECT_NEAR(lobe_integral(pq), integral, 1e-5F * integral + 1e-30F);
    EXPECT_NEAR(lobe_integral(qp), integral, 2e-5F * integral + 1e-30F);
    EXPECT_NEAR(pq.exponent, qp.exponent, 1e-4F * (1 + pq.exponent));
    if (a.dot(b) > -0.99F) {
      EXPECT_LT((pq.axis - qp.axis).length() * std::sqrt(pq.exponent + 1), 1e-2F);
    }
    EXPECT_NEAR(pq.axis.length(), 1, 1e-6F);
  }
}

TEST(LobeTable, ExtremesStayFinite) {
  const float largest = max_lobe_exponent;
  for (const float e1 : {0.0F, 1e-30F, 1.0F, largest, 10 * largest}) {
    for (const float e2 : {0.0F, 0.5F, largest}) {
      for (const V3f& b : {V3f(1, 0, 0), V3f(-1, 0, 0), V3f(0, 1, 0), V3f(-1, 1e-7F, 0).normalized()}) {
        const Lobe product = lobe_product(table(), {V3f(1, 0, 0), e1, 1}, {b, e2, 1});
        EXPECT_TRUE(std::isfinite(product.scale) && std::isfinite(product.exponent) && product.exponent >= 0);
        EXPECT_GE(product.scale, 0);
        EXPECT_NEAR(product.axis.length(), 1, 1e-5F);
      }
    }
  }
  EXPECT_LT(lobe_product_integral(table(), {V3f(1, 0, 0), 3, 1}, {V3f(-1, 0, 0), 5, 1}), 1e-10F);
  EXPECT_THROW(make_lobe_table({1, 65}), ParameterError);
}

TEST(CapLobe, HasTheCapsSolidAngleAndVectorMoment) {
  for (const float c : {0.0F, 0.2F, 0.7F, 0.9F, 0.99F, 0.999F}) {
    const Lobe lobe = cap_lobe(V3f(0, 1, 0), c);
    EXPECT_NEAR(lobe_integral(lobe), 2 * pi * (1 - c), 1e-5F * (1 - c) * 2 * pi);
    // Mean cosine of a lobe (e + 1)/(e + 2), of a cap (1 + c)/2.
    EXPECT_NEAR((lobe.exponent + 1) / (lobe.exponent + 2), 0.5F * (1 + c), 2e-6F);
  }
  EXPECT_FLOAT_EQ(cap_lobe(V3f(0, 1, 0), 0).exponent, 0);  // the hemisphere itself
  // Narrower than any exponent: the solid angle stays.
  const Lobe tiny = cap_lobe_from_height(V3f(0, 1, 0), 1e-9F);
  EXPECT_NEAR(lobe_integral(tiny) / (2 * pi * 1e-9F), 1, 1e-5F);
  EXPECT_EQ(cap_lobe_from_height(V3f(0, 1, 0), 0).scale, 0);
}

// Irradiance of a spherical light above the horizon: pi sin^2(half-angle) cos(theta), exactly.
TEST(CapLobe, LightsAMattSurfaceExactly) {
  for (const double half : {0.02, 0.2, 0.5}) {
    for (const double theta : {0.0, 0.4, 0.8}) {
      const Lobe light = cap_lobe(in_plane(theta), float(std::cos(half)));
      const double e = lobe_product_integral(table(), {in_plane(0), 1, 1}, light);
      // 1e-3: the lobe's tail below the horizon, at theta + half = 1.3, and the table.
      EXPECT_NEAR(e / (pi_d * std::sin(half) * std::sin(half) * std::cos(theta)), 1, 1e-3);
    }
  }
}

TEST(Sphere, CapHeightKeepsItsDigits) {
  EXPECT_NEAR(double(sphere_cap_height(1e-3F, 1)), 5.000001e-7 * 0.99999975, 1e-12);
  EXPECT_FLOAT_EQ(sphere_cap_height(1, 1), 1);
}

}  // namespace
}  // namespace ivory
