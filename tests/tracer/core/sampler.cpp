// Low-discrepancy points: evenness of each sequence, randomness over sequences.
#include "tracer/core/sampler.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"
#include "tracer/core/low_discrepancy.h"

namespace ivory {
namespace {

// A (0,2)-sequence in base 2: any 2^k successive points from a multiple of 2^k put exactly one into each
// of the k + 1 families of boxes 2^-i by 2^(i-k).
TEST(SobolPoints, FillElementaryIntervals) {
  for (const std::uint32_t seed : {0U, 1U, 12345U, 0xffffffffU}) {
    for (const unsigned k : {4U, 6U, 10U}) {
      for (const std::uint32_t block : {0U, 3U}) {
        for (unsigned i = 0; i <= k; ++i) {
          std::vector<int> counts(std::size_t(1) << k, 0);
          for (std::uint32_t n = 0; n < (1U << k); ++n) {
            const auto point = sobol_point((block << k) + n, seed);
            const std::uint32_t column = i == 0 ? 0 : point[0] >> (32 - i);
            const std::uint32_t row = i == k ? 0 : point[1] >> (32 - (k - i));
            ++counts[(column << (k - i)) | row];
          }
          for (const int count : counts) ASSERT_EQ(count, 1) << seed << " " << k << " " << i;
        }
      }
    }
  }
}

// One and the same index over many seeds is uniform over the square: without that, estimates would be biased.
TEST(SobolPoints, AreUniformOverSeeds) {
  for (const std::uint32_t index : {0U, 1U, 5U, 63U}) {
    std::vector<double> counts(256, 0);
    constexpr int seeds = 100000;
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
      const auto point = sobol_point(index, seed);
      counts[(point[0] >> 28U) * 16 + (point[1] >> 28U)] += 1;
    }
    // One-sided: false alarm once in 31,000.
    EXPECT_LT(chi_square_score(counts, std::vector<double>(256, seeds / 256.0)), 4.0) << index;
  }
}

// Two calls of one sample must not know of each other: pairs of their coordinates are uniform.
TEST(SobolPoints, CallsAreIndependent) {
  std::vector<double> counts(256, 0);
  RandomStream keys(1, StreamPurpose::test, 0);
  constexpr int pairs = 100000;
  for (int i = 0; i < pairs / 50; ++i) {
    RandomStream random(1, StreamPurpose::test, 1);
    const std::uint32_t key = keys.next_u32();
    for (std::uint32_t sample = 0; sample < 50; ++sample) {
      random.begin_sample(sample, key, 2);
      const std::uint32_t a = random.next_u32() >> 28U;
      counts[a * 16 + (random.next_u32() >> 28U)] += 1;
    }
  }
  // Evenness within a sequence makes chi-square smaller, dependence makes it larger.
  EXPECT_LT(chi_square_score(counts, std::vector<double>(256, pairs / 256.0)), 4.0);
}

TEST(RandomStream, ReturnsToIndependentNumbersAfterTheEvenOnes) {
  RandomStream plain(1, StreamPurpose::test, 7);
  RandomStream mixed(1, StreamPurpose::test, 7);
  mixed.begin_sample(3, 99, 2);
  const V2f first = mixed.next2();
  mixed.next_u32();
  EXPECT_NE(first, V2f(0, 0));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(plain.next_u32(), mixed.next_u32());
}

// All branches of all samples make one even set; afterwards the sample goes on as if there had been none.
TEST(RandomStream, BranchesAreNumberedThrough) {
  RandomStream random(1, StreamPurpose::test, 0);
  RandomStream unbranched(1, StreamPurpose::test, 0);
  constexpr std::uint32_t samples = 16;
  constexpr std::uint32_t branches = 4;
  std::vector<int> counts(64, 0);
  for (std::uint32_t s = 0; s < samples; ++s) {
    random.begin_sample(s, 77, 3);
    unbranched.begin_sample(s, 77, 3);
    EXPECT_EQ(random.next_u32(), unbranched.next_u32());
    for (std::uint32_t i = 0; i < branches; ++i) {
      random.begin_branch(i, branches, 1);
      const V2f u = random.next2();
      ++counts[std::size_t(u.x * 8) * 8 + std::size_t(u.y * 8)];
    }
    random.end_branches();
    EXPECT_EQ(random.next2(), unbranched.next2());
    EXPECT_EQ(random.next(), unbranched.next());
    EXPECT_EQ(random.next(), unbranched.next());  // independent again
  }
  for (const int count : counts) EXPECT_EQ(count, 1);
}

TEST(RandomStream, BranchesOutsideASampleAreIndependent) {
  RandomStream random(1, StreamPurpose::test, 0);
  RandomStream plain(1, StreamPurpose::test, 0);
  for (std::uint32_t i = 0; i < 5; ++i) {
    random.begin_branch(i, 5, 3);
    EXPECT_EQ(random.next_u32(), plain.next_u32());
  }
  random.end_branches();
  EXPECT_EQ(random.next_u32(), plain.next_u32());
}

// The point of it: the mean of a smooth function over 64 samples is far closer than by independent numbers.
TEST(RandomStream, EvenSamplesConvergeFaster) {
  Accumulator even;
  Accumulator independent;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    RandomStream random(1, StreamPurpose::test, i);
    const std::uint32_t key = random.next_u32();
    double mean[2] = {0, 0};
    for (std::uint32_t sample = 0; sample < 64; ++sample) {
      random.begin_sample(sample, key, 1);
      const V2f a = random.next2();
      const V2f b = random.next2();
      mean[0] += std::exp(double(a.x * a.y)) / 64;
      mean[1] += std::exp(double(b.x * b.y)) / 64;
    }
    even.add(mean[0]);
    independent.add(mean[1]);
  }
  // Integral of exp(xy) over the unit square: sum of 1/(n! (n+1)^2).
  EXPECT_LT(std::abs(z_score(even, 1.3179021514544038)), z_limit);
  EXPECT_LT(std::abs(z_score(independent, 1.3179021514544038)), z_limit);
  EXPECT_LT(even.variance() * 50, independent.variance());
}

}  // namespace
}  // namespace ivory
