// Six irradiance vectors as norms and directions.
#include "grid/field/compact_vectors.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace ivory {
namespace {

V3f random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return V3f(normal(random), normal(random), normal(random)).normalized();
}

// Moments of a few lights; of one colour all where `one_colour`.
std::array<float, 36> random_moments(std::mt19937& random, bool one_colour) {
  std::uniform_real_distribution<float> uniform(0, 1);
  std::array<float, 36> moments{};
  const Rgb common(uniform(random), uniform(random), uniform(random));
  for (int light = 0; light < 5; ++light) {
    const auto f = eval(Basis::vectors, random_direction(random));
    const Rgb colour = one_colour ? common * uniform(random) : Rgb(uniform(random), uniform(random), uniform(random));
    for (std::size_t k = 0; k < 12; ++k) {
      for (std::size_t c = 0; c < 3; ++c) moments[3 * k + c] += f[k] * colour[unsigned(c)];
    }
  }
  return moments;
}

// Where all light is of one colour, the channels share their direction and nothing is lost but rounding.
TEST(CompactVectors, LightOfOneColourIsKept) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const auto moments = random_moments(random, true);
    const auto back = moments_from_compact(compact_from_moments(moments), random_direction(random));
    for (std::size_t k = 0; k < 36; ++k) ASSERT_NEAR(back[k], moments[k], 1e-5F) << i;  // sums of order one
  }
  const auto dark = moments_from_compact(compact_from_moments(std::array<float, 36>{}), V3f(0, 1, 0));
  for (const float m : dark) EXPECT_EQ(m, 0);
}

// Norms are those of the vectors; no other direction comes nearer to the three of them.
TEST(CompactVectors, DirectionIsTheBest) {
  std::mt19937 random(2);
  for (int i = 0; i < 1000; ++i) {
    const auto moments = random_moments(random, false);
    const auto compact = compact_from_moments(moments);
    const auto h = hemispheres_from_moments(moments);
    for (std::size_t hemisphere = 0; hemisphere < 6; ++hemisphere) {
      const auto error = [&](const V3f& d) {
        float sum = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          const V3f vector(h[9 * hemisphere + c], h[9 * hemisphere + 3 + c], h[9 * hemisphere + 6 + c]);
          EXPECT_NEAR(compact[3 * hemisphere + c], vector.length(), 1e-5F);
          sum += (vector - d * vector.length()).length2();
        }
        return sum;
      };
      const float* d = compact.data() + 18 + 3 * hemisphere;
      const V3f best(d[0], d[1], d[2]);
      if (best.length() == 0) continue;
      EXPECT_NEAR(best.length(), 1, 1e-5F);
      for (int trial = 0; trial < 5; ++trial) {
        const V3f other = (best + random_direction(random) * 0.1F).normalized();
        EXPECT_LE(error(best), error(other) + 1e-6F);
      }
    }
  }
}

// At a normal along an axis, E by the paper is what that axis's own hemisphere says, whatever the other axes round to.
TEST(CompactVectors, AxesReadTheirOwnHemisphere) {
  std::mt19937 random(3);
  const auto compact = compact_from_moments(random_moments(random, false));
  for (std::size_t hemisphere = 0; hemisphere < 6; ++hemisphere) {
    V3f n(0, 0, 0);
    n[unsigned(hemisphere / 2)] = hemisphere % 2 == 0 ? 1.0F : -1.0F;
    const auto moments = moments_from_compact(compact, n);
    const Rgb e = irradiance(Basis::vectors, Reconstruction::paper, moments.data(), n);
    const float cosine = compact[18 + 3 * hemisphere + hemisphere / 2] * n[unsigned(hemisphere / 2)];
    for (unsigned c = 0; c < 3; ++c) EXPECT_NEAR(e[c], compact[3 * hemisphere + c] * cosine, 1e-5F);
  }
}

}  // namespace
}  // namespace ivory
