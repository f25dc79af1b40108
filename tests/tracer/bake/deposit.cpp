// Depositing photon segments: exact lengths, sampled lengths, integer sums.
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "tracer/bake/field/deposit/photon_deposit.h"
#include "tracer/core/sampler.h"

namespace ivory {
namespace {

GridFrame test_frame() {
  GridFrame frame;
  frame.size = V3i(7, 5, 6);
  frame.origin_m = V3f(-1, 2, 0.5F);
  frame.spacing_m = V3f(0.25F, 0.4F, 0.3F);
  // 40 degrees about Y: nothing may depend on the grid's axes being the world's.
  const float c = std::cos(0.7F);
  const float s = std::sin(0.7F);
  frame.local_to_world = M33f(c, 0, -s, 0, 1, 0, s, 0, c);
  return frame;
}

DepositTarget test_target(const GridFrame& frame, Basis basis = Basis::vectors, Estimator estimator = Estimator::track,
                          int fine_bits = 0) {
  return make_deposit_target(frame, basis, estimator, 1.0F,
                             std::vector<std::uint64_t>(frame.vertex_count(), ~std::uint64_t(0)), fine_bits);
}

constexpr int fine = 12;

std::vector<PhotonSegment> random_segments(const GridFrame& frame, int count, std::uint64_t seed) {
  RandomStream random(seed, StreamPurpose::test, 0);
  std::vector<PhotonSegment> segments;
  for (int i = 0; i < count; ++i) {
    PhotonSegment s;
    const V3f index(random.next() * 9 - 1, random.next() * 7 - 1, random.next() * 8 - 1);
    s.origin = frame.to_world(index);
    s.direction = V3f(random.next() - 0.5F, random.next() - 0.5F, random.next() - 0.5F).normalized();
    s.length_m = i % 7 == 0 ? std::numeric_limits<float>::infinity() : random.next() * 2;
    s.power_lm = Rgb(random.next(), random.next(), random.next());
    s.jitter = random.next();
    segments.push_back(s);
  }
  return segments;
}

std::vector<std::int64_t> deposited(DepositTarget target, const std::vector<PhotonSegment>& segments,
                                    TrackWalk walk = TrackWalk::sampled) {
  PhotonDepositor depositor(target, walk);
  depositor.deposit(segments);
  depositor.flush();
  return target.sums;
}

// Length of a segment inside the grid's box by the slow road: a million points.
TEST(Deposit, ExactWalkAddsUpToTheClippedLength) {
  const GridFrame frame = test_frame();
  const DepositTarget target = test_target(frame);
  for (PhotonSegment segment : random_segments(frame, 12, 5)) {
    segment.power_lm = Rgb(1, 1, 1);
    segment.length_m = std::min(segment.length_m, 6.0F);
    const auto sums = deposited(target, {segment}, TrackWalk::exact);
    V3d moment(0, 0, 0);
    for (std::size_t i = 0; i < sums.size(); i += 12) {
      for (unsigned axis = 0; axis < 3; ++axis) moment[axis] += double(sums[i + 3 * axis]) * target.quantum;
    }
    constexpr int points = 200'000;
    int inside = 0;
    for (int i = 0; i < points; ++i) {
      const V3f p = segment.origin + segment.direction * (segment.length_m * (float(i) + 0.5F) / points);
      const V3f index = frame.to_index(p);
      bool in = true;
      for (unsigned axis = 0; axis < 3; ++axis)
        in = in && index[axis] >= -0.5F && index[axis] <= float(frame.size[axis]) - 0.5F;
      if (in) ++inside;
    }
    const double length_m = double(segment.length_m) * inside / points;
    const V3f w = frame.direction_to_local(segment.direction);
    for (unsigned axis = 0; axis < 3; ++axis) {
      // Two points of the slow road at either end, and a quantum's half for each of at most 30 cells.
      const double tolerance = 2.0 * segment.length_m / points + 30 * target.quantum;
      EXPECT_NEAR(moment[axis], length_m * std::abs(w[axis]), tolerance);
    }
  }
}

// One segment, many jitters: the mean over jitters is the exact deposit. z <= 5 over at most 400 lanes
// that are hit: a false alarm once in 4,000 runs, and the seed is fixed.
TEST(Deposit, SampledWalkIsUnbiased) {
  const GridFrame frame = test_frame();
  for (const bool masked : {false, true}) {
    DepositTarget target = test_target(frame);
    if (masked) {
      RandomStream random(3, StreamPurpose::test, 1);
      for (std::uint64_t& mask : target.cell_masks)
        mask = (std::uint64_t(random.next_u32()) << 32U) | random.next_u32();
    }
    for (const PhotonSegment& segment : random_segments(frame, 4, 9)) {
      const auto exact = deposited(target, {segment}, TrackWalk::exact);
      RandomStream random(11, StreamPurpose::test, 2);
      constexpr int trials = 2000;
      std::vector<double> sum(exact.size());
      std::vector<double> squares(exact.size());
      for (int trial = 0; trial < trials; ++trial) {
        PhotonSegment jittered = segment;
        jittered.jitter = random.next();
        const auto sampled = deposited(target, {jittered});
        for (std::size_t i = 0; i < sampled.size(); ++i) {
          sum[i] += double(sampled[i]);
          squares[i] += double(sampled[i]) * double(sampled[i]);
        }
      }
      for (std::size_t i = 0; i < exact.size(); ++i) {
        if (i % 12 >= 9) continue;  // second moments are those of the sampling itself
        const double mean = sum[i] / trials;
        const double se = std::sqrt(std::max(0.0, squares[i] / trials - mean * mean) / trials);
        // Rounding to whole units is the only other difference: half a unit per cell or quarter cell.
        EXPECT_LE(std::abs(mean - double(exact[i])), 5 * se + 8) << "lane " << i;
      }
    }
  }
}

TEST(Deposit, HiddenSubcellsTakeNothing) {
  const GridFrame frame = test_frame();
  DepositTarget target = test_target(frame);
  const auto segments = random_segments(frame, 200, 4);
  const auto all = deposited(target, segments, TrackWalk::exact);
  for (std::uint64_t& mask : target.cell_masks) mask = 0x5A5A5A5A5A5A5A5AU;
  const auto some = deposited(target, segments, TrackWalk::exact);
  for (std::uint64_t& mask : target.cell_masks) mask = ~mask;
  const auto others = deposited(target, segments, TrackWalk::exact);
  for (std::uint64_t& mask : target.cell_masks) mask = 0;
  const auto none = deposited(target, segments);
  EXPECT_EQ(std::accumulate(none.begin(), none.end(), std::int64_t(0)), 0);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % 12 < 9) {
      EXPECT_NEAR(double(some[i] + others[i]), double(all[i]), 1e-4 * double(all[i]) + 200);  // half a unit a step
    }
  }
}

// The sums do not depend on batches or on who deposits what.
TEST(Deposit, SumsAreTheSameInAnyOrder) {
  const GridFrame frame = test_frame();
  for (const Basis basis : all_bases) {
    for (const Estimator estimator : {Estimator::track, Estimator::face, Estimator::face_paper}) {
      if (estimator != Estimator::track && basis != Basis::vectors) continue;
      DepositTarget whole = test_target(frame, basis, estimator, fine);
      DepositTarget parts = whole;
      auto segments = random_segments(frame, 1000, 2);
      for (std::size_t i = 0; i < segments.size(); i += 3) segments[i].power_lm *= i % 2 == 0 ? 1e-6F : 1e-9F;
      PhotonDepositor one(whole);
      one.deposit(segments);
      one.flush();
      PhotonDepositor a(parts);
      PhotonDepositor b(parts);
      b.deposit({segments.begin() + 700, segments.end()});
      a.deposit({segments.begin(), segments.begin() + 331});
      b.deposit({segments.begin() + 331, segments.begin() + 700});
      b.flush();
      a.flush();
      EXPECT_EQ(whole.sums, parts.sums) << name_of(basis) << " " << name_of(estimator);
      EXPECT_NE(std::accumulate(whole.sums.begin(), whole.sums.end(), std::int64_t(0)), 0);
    }
  }
}

// 32-bit lanes spill before they overflow, and deposits too large for them go another way: the sum of
// many is the multiple of one.
TEST(Deposit, NothingOverflows) {
  const GridFrame frame = test_frame();
  for (const int bits : {0, fine}) {
    const DepositTarget target = test_target(frame, Basis::vectors, Estimator::track, bits);
    PhotonSegment segment = random_segments(frame, 1, 8)[0];
    segment.origin = frame.to_world(V3f(3, 2, 2.5F));
    segment.length_m = 0.2F;
    // As many as 64 bits hold of the second moments of photons stronger than any should be.
    for (const auto& [power, count] : {std::pair(1e-2F, 20'000), std::pair(1.0F, 20'000), std::pair(60.0F, 20'000),
                                       std::pair(2e3F, 1000), std::pair(2e4F, 10)}) {
      segment.power_lm = Rgb(power, power, power);
      const auto one = deposited(target, {segment});
      const auto many = deposited(target, std::vector<PhotonSegment>(std::size_t(count), segment));
      ASSERT_GT(*std::max_element(one.begin(), one.end()), 0);
      for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(many[i], one[i] * count) << power << " " << bits;
    }
  }
}

// Photons far below a quantum still add up to their light. A power of 1e-12 of the strongest is 1e-3 quanta of 2^-30
// over a voxel: one deposit in a thousand is one quantum. z <= 5 for 5 powers, 3 axes and 3 ways to deposit.
TEST(Deposit, WeakPhotonsAreNotLostToRounding) {
  const GridFrame frame = test_frame();
  const float voxel_m = (frame.spacing_m.x + frame.spacing_m.y + frame.spacing_m.z) / 3;
  struct Way {
    Estimator estimator;
    TrackWalk walk;
  };
  for (const Way way : {Way{Estimator::track, TrackWalk::sampled}, Way{Estimator::track, TrackWalk::exact},
                        Way{Estimator::face, TrackWalk::sampled}}) {
    const DepositTarget target = test_target(frame, Basis::vectors, way.estimator, fine);
    for (const float power : {1e-3F, 1e-6F, 1e-8F, 1e-10F, 1e-12F}) {
      RandomStream random(23, StreamPurpose::test, 0);
      constexpr int batches = 50;
      std::array<double, 3> sum{};
      std::array<double, 3> squares{};
      double truth = 0;
      const float crossing_m = float(frame.size.z) * frame.spacing_m.z;
      for (int batch = 0; batch < batches; ++batch) {
        std::vector<PhotonSegment> segments;
        for (int i = 0; i < 4000; ++i) {
          // Straight through the grid along its z, each at its own place.
          const V3f index(random.next() * 7 - 0.5F, random.next() * 5 - 0.5F, -2);
          segments.push_back({frame.to_world(index), frame.direction_to_world(V3f(0, 0, 1)),
                              std::numeric_limits<float>::infinity(), Rgb(power, power, power) * 0.37F, random.next()});
        }
        truth = 4000 * 0.37 * double(power) * (way.estimator == Estimator::face ? frame.size.z : double(crossing_m));
        const auto sums = deposited(target, segments, way.walk);
        std::array<double, 3> moment{};
        for (std::size_t i = 0; i < sums.size(); i += 12) {
          for (unsigned c = 0; c < 3; ++c) moment[c] += std::abs(double(sums[i + 6 + c])) * target.quantum;
        }
        for (unsigned c = 0; c < 3; ++c) {
          sum[c] += moment[c];
          squares[c] += moment[c] * moment[c];
        }
      }
      for (unsigned c = 0; c < 3; ++c) {
        const double mean = sum[c] / batches;
        const double variance = std::max(0.0, squares[c] / batches - mean * mean);
        // 1e-5: single precision on the way, as a share of the light.
        EXPECT_NEAR(mean, truth, 5 * std::sqrt(variance / (batches - 1)) + 1e-5 * truth)
            << name_of(way.estimator) << " " << int(way.walk) << " " << power;
        // At most a quarter of a quantum^2 for each deposit, six a photon, all alike along a photon.
        EXPECT_LT(variance, 4000 * (0.25 * 36 * target.quantum * target.quantum) + 1e-9 * truth * truth)
            << name_of(way.estimator) << " " << power << " " << voxel_m;
      }
    }
  }
}

TEST(Deposit, DegenerateSegmentsAreHarmless) {
  const GridFrame frame;  // 2 x 2 x 2 below
  GridFrame small = frame;
  small.size = V3i(2, 2, 2);
  const DepositTarget target = test_target(small);
  std::vector<PhotonSegment> segments;
  for (const V3f& d : {V3f(1, 0, 0), V3f(0, -1, 0), V3f(0, 0, 1)}) {
    for (const V3f& o : {V3f(-0.5F, -0.5F, -0.5F), V3f(1.5F, 1.5F, 1.5F), V3f(0, 0, 0), V3f(0.5F, 0.5F, 0.5F)}) {
      for (const float length : {0.0F, 1e-30F, 1.0F, std::numeric_limits<float>::infinity()})
        segments.push_back({o, d, length, Rgb(1, 1, 1), 0.999F});
    }
  }
  for (const TrackWalk walk : {TrackWalk::sampled, TrackWalk::exact}) {
    for (const std::int64_t sum : deposited(target, segments, walk)) {
      EXPECT_GE(sum, 0);  // octant moments are sums of |w|
      EXPECT_LT(sum, std::int64_t(1) << 40U);
    }
  }
}

}  // namespace
}  // namespace ivory
