// Deposits into several spacings: each level takes what a uniform grid of its spacing would.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/random_lattice.h"
#include "tracer/bake/field/deposit/photon_deposit.h"
#include "tracer/core/sampler.h"

namespace ivory {
namespace {

constexpr int fine = 12;

std::vector<PhotonSegment> random_segments(const GridFrame& frame, int count, std::uint64_t seed) {
  RandomStream random(seed, StreamPurpose::test, 0);
  std::vector<PhotonSegment> segments;
  for (int i = 0; i < count; ++i) {
    PhotonSegment s;
    V3f index;
    for (int axis = 0; axis < 3; ++axis) index[axis] = random.next() * float(frame.size[axis] + 2) - 1.5F;
    s.origin = frame.to_world(index);
    s.direction = V3f(random.next() - 0.5F, random.next() - 0.5F, random.next() - 0.5F).normalized();
    s.length_m = i % 7 == 0 ? std::numeric_limits<float>::infinity() : random.next() * 4;
    // Some by the fine unit, some too large for 32 bits.
    s.power_lm = Rgb(random.next(), random.next(), random.next()) * (i % 5 == 0 ? 1e-5F : i % 11 == 0 ? 300.0F : 1.0F);
    s.jitter = random.next();
    segments.push_back(s);
  }
  return segments;
}

// Half of the subcells of each vertex, the same for the same vertex of a level.
std::vector<std::uint64_t> some_masks(const Lattice& lattice) {
  std::vector<std::uint64_t> masks(lattice.vertex_count());
  for (std::uint32_t v = 0; v < masks.size(); ++v) {
    const VertexPlace place = lattice.place_of(v);
    const V3i size = lattice.frame_of(place.level).size;
    // Multiplied by the golden ratio twice, which mixes the bits that are asked for.
    std::uint64_t bits =
        std::uint64_t(size.x) << 48U ^ lattice.frame_of(place.level).vertex_index(place.at.x, place.at.y, place.at.z);
    for (int i = 0; i < 2; ++i) {
      bits *= 0x9e3779b97f4a7c15U;
      bits ^= bits >> 31U;
    }
    masks[v] = bits;
  }
  return masks;
}

GridAccumulator deposited(const Lattice& lattice, const std::vector<PhotonSegment>& segments, Basis basis,
                          DepositBuffers buffers, TrackWalk walk = TrackWalk::sampled) {
  DepositTarget target =
      make_deposit_target(lattice, basis, Estimator::track, 1.0F, some_masks(lattice), fine, 0, buffers);
  PhotonDepositor depositor(target, walk);
  depositor.deposit(segments);
  depositor.flush();
  return to_accumulator(std::move(target));
}

// The same photons leave the same sums in a level as in a uniform grid of its spacing, to the bit, whatever bricks it
// has and however they are jumped over; quanta are smaller by the level.
TEST(LatticeDeposit, EachLevelIsAUniformGridsPart) {
  for (const bool rotated : {false, true}) {
    const Lattice lattice = random_lattice(V3i(6, 4, 10), 4, 0.01, rotated ? 1 : 2, rotated);
    ASSERT_EQ(lattice.levels(), 4);
    const auto segments = random_segments(lattice.frame, 3000, 3);
    for (const Basis basis : {Basis::vectors, Basis::sh9}) {
      const GridAccumulator sums = deposited(lattice, segments, basis, DepositBuffers::own);
      const auto stride = std::size_t(sum_layout(basis, Estimator::track).stride());
      for (int level = 0; level < 4; ++level) {
        const GridFrame& frame = lattice.frame_of(level);
        const GridAccumulator uniform = deposited(frame, segments, basis, DepositBuffers::own);
        EXPECT_EQ(std::ldexp(sums.quantum, -level), uniform.quantum);
        EXPECT_EQ(std::ldexp(sums.quantum_squared, -2 * level), uniform.quantum_squared);
        std::int64_t largest = 0;
        for (std::uint32_t v = 0; v < lattice.vertex_count(); ++v) {
          const VertexPlace place = lattice.place_of(v);
          if (place.level != level) continue;
          const std::size_t there = frame.vertex_index(place.at.x, place.at.y, place.at.z);
          for (std::size_t i = 0; i < stride; ++i) {
            ASSERT_EQ(sums.sums[v * stride + i], uniform.sums[there * stride + i]) << level << " " << place.at;
            largest = std::max(largest, std::abs(sums.sums[v * stride + i]));
          }
        }
        EXPECT_GT(largest, 0) << "nothing was tested";
      }
    }
  }
}

// What a cell takes is what its eight parts take together, by exact lengths: of at most 30 roundings to half a coarse
// unit of either level, and single precision.
TEST(LatticeDeposit, ACellTakesWhatItsPartsTake) {
  const Lattice lattice = whole_lattice(coarsest_frame(V3i(4, 2, 6), true), 2);
  auto segments = random_segments(lattice.frame, 200, 4);
  for (PhotonSegment& s : segments) s.power_lm = Rgb(1, 1, 1);
  DepositTarget target = make_deposit_target(lattice, Basis::sh4, Estimator::track, 1.0F,
                                             std::vector<std::uint64_t>(lattice.vertex_count(), ~std::uint64_t(0)));
  PhotonDepositor depositor(target, TrackWalk::exact);
  depositor.deposit(segments);
  depositor.flush();
  const GridAccumulator sums = to_accumulator(std::move(target));
  const BrickLevel& bricks = lattice.finer[0];
  for (std::uint32_t v = 0; v < lattice.frame.vertex_count(); ++v) {
    const V3i at = lattice.place_of(v).at;
    double parts = 0;
    for (int child = 0; child < 8; ++child)
      parts += double(sums.sums[bricks.vertex_at(at * 2 + V3i(child & 1, child >> 1 & 1, child >> 2)) * 15]) / 2;
    EXPECT_NEAR(double(sums.sums[v * 15]), parts, 200 + 1e-5 * parts);
  }
}

TEST(LatticeDeposit, SharedSumsAreThoseOfOwnBuffers) {
  const Lattice lattice = random_lattice(V3i(6, 6, 6), 3, 0.05, 5);
  const auto segments = random_segments(lattice.frame, 2000, 6);
  for (const Basis basis : all_bases) {
    for (const TrackWalk walk : {TrackWalk::sampled, TrackWalk::exact}) {
      const GridAccumulator own = deposited(lattice, segments, basis, DepositBuffers::own, walk);
      const GridAccumulator shared = deposited(lattice, segments, basis, DepositBuffers::shared, walk);
      EXPECT_EQ(own.sums, shared.sums) << name_of(basis);
    }
  }
  for (const Estimator estimator : {Estimator::face, Estimator::face_paper}) {
    EXPECT_THROW(make_deposit_target(lattice, Basis::vectors, estimator, 1.0F, some_masks(lattice)), ParameterError);
    std::vector<GridAccumulator> both;
    for (const DepositBuffers buffers : {DepositBuffers::own, DepositBuffers::shared}) {
      DepositTarget target = make_deposit_target(lattice.frame, Basis::vectors, estimator, 1.0F,
                                                 some_masks(lattice.frame), fine, 0, buffers);
      PhotonDepositor depositor(target);
      depositor.deposit(segments);
      depositor.flush();
      both.push_back(to_accumulator(std::move(target)));
    }
    EXPECT_EQ(both[0].sums, both[1].sums) << name_of(estimator);
  }
}

}  // namespace
}  // namespace ivory
