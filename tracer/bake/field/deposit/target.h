// Where photon deposits go: the integer sums that all threads share, and a segment's place in the grid.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "grid/field/accumulator.h"
#include "tracer/bake/field/deposit/track_samples.h"
#include "tracer/render/photons/tracer.h"

namespace ivory {

// How threads add to the sums. Either way the bytes are the same.
enum class DepositBuffers {
  own,  // to 32-bit sums of their own first: fast while a thread's fit into its cache, but each needs up to 2/3 as much
        // memory as all share
  shared,  // to the shared sums at once, one thread at a time for each slot of a vertex
};

// Integer addition commutes, so neither the order of the threads nor how the photons were cut into
// batches leaves a trace in the sums.
struct DepositTarget {
  Lattice lattice;
  Basis basis = Basis::vectors;
  Estimator estimator = Estimator::track;
  SumLayout layout;
  DepositBuffers buffers = DepositBuffers::own;
  double quantum = 0;  // as in GridAccumulator
  double quantum_squared = 0;
  float units_a_lm = 0;  // coarse units that a lumen is worth, and
  float to_second = 0;   // what their squares are multiplied by to be those of second moments
  int fine_bits = 0;  // deposits are counted in coarse units of 2^fine_bits quanta, those too small for that in quanta
  std::vector<std::uint64_t> cell_masks;  // [vertex] 4x4x4 subcells that the vertex sees, x fastest; track only
  std::vector<std::int64_t> sums;         // [slot][vertex][lane]; shared buffers: [vertex][slot][lane]

  std::size_t lane_index(std::size_t slot, std::size_t vertex) const {
    const std::size_t at = buffers == DepositBuffers::shared ? vertex * std::size_t(layout.slots) + slot
                                                             : slot * cell_masks.size() + vertex;
    return at * std::size_t(layout.lanes());
  }
};

// Bytes of one thread's own sums from which on they pay no more, and are shared.
inline constexpr double most_own_bytes = 88.0 * 1024 * 1024;
double own_bytes(std::size_t vertices, const SumLayout& layout, int fine_bits);
DepositBuffers choose_buffers(std::size_t vertices, const SumLayout& layout, int fine_bits);

// Sizes the sums and picks the quanta: a photon of `power_lm` (its strongest channel) crossing one voxel
// (of the coarsest level, the finer ones' units being so much smaller) is 2^18 coarse units, which leaves rounding far
// below the photon noise even for channels and direction components 10,000 times weaker. Where few photons may carry up
// to heaviest_lm, the quanta of second moments are larger, as far as that lets 64 bits hold theirs. Throws
// ParameterError for a face estimator in a lattice of several levels.
DepositTarget make_deposit_target(const Lattice& lattice, Basis basis, Estimator estimator, float power_lm,
                                  std::vector<std::uint64_t> cell_masks, int fine_bits = 0, float heaviest_lm = 0,
                                  DepositBuffers buffers = DepositBuffers::own);

// Throws so.
void check_estimator(const Lattice& lattice, Estimator estimator);

// The fine bits that a scene's lights ask for. Where a sun shines into a scene, the photons of a lamp indoors may
// carry a millionth of the strongest power: rounded to 2^-18 of that, the lamp's room would be dark, not noisy. 12
// bits make the quanta 2^-30, at which the 64-bit sums still hold 2^31 of the strongest deposits in one voxel, of
// which the second moment may be 3 units of 2^30; what is weaker yet is rounded at random (see
// tracer/bake/field/deposit/photon_deposit.cpp). None where all photons are above 2^-6 of the strongest, as with a
// single light: their deposits are 2^12 coarse units, and second moments 2^6.
inline constexpr int max_fine_bits = 12;
int fine_bits(const Lights::PhotonPower& power);

// Moves the sums out, [vertex][slot][lane] as a GridAccumulator has them; then the target has none. And back.
std::vector<std::int64_t> take_sums(DepositTarget& target);
void put_sums(DepositTarget& target, std::vector<std::int64_t> by_vertex);

// What a bake keeps of it: lattice, basis, estimator, quanta and the sums by vertex. All else is left empty.
GridAccumulator to_accumulator(DepositTarget target);

// The part of a segment inside the grid's box, in index coordinates shifted by one half: vertex i's cell
// is [i, i + 1).
struct IndexSegment {
  V3f start;
  V3f per_metre;
  float length_m = 0;
  V3f w;  // in the grid's own axes, towards the light
};
inline std::optional<IndexSegment> clip(const GridFrame& frame, const PhotonSegment& segment) {
  // By reciprocals: where one level's are the halves of another's, so are its index coordinates, to the bit.
  const V3f voxels_a_metre(1 / frame.spacing_m.x, 1 / frame.spacing_m.y, 1 / frame.spacing_m.z);
  const V3f origin = frame.direction_to_local(segment.origin - frame.origin_m) * voxels_a_metre + V3f(0.5F, 0.5F, 0.5F);
  const V3f local = frame.direction_to_local(segment.direction);
  const V3f direction = local * voxels_a_metre;
  float t0 = 0;
  float t1 = segment.length_m;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const auto last = static_cast<float>(frame.size[axis]);
    // A zero component gives infinities of the right signs, or, on the very border, a NaN that the
    // comparisons below ignore.
    const float inverse = 1 / direction[axis];
    const float a = -origin[axis] * inverse;
    const float b = (last - origin[axis]) * inverse;
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }
  if (!(t1 > t0)) return std::nullopt;
  return IndexSegment{origin + direction * t0, direction, t1 - t0, -local};
}

// One jittered position a slice of the dominant axis; nothing where none lies inside.
inline float sample_step_m(const IndexSegment& inside) {
  const V3f& d = inside.per_metre;
  return 1 / std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
}
inline std::optional<SampleRun> sample_run(const IndexSegment& inside, float jitter) {
  const V3f& d = inside.per_metre;
  const float step_m = sample_step_m(inside);
  const float first_m = jitter * step_m;
  if (first_m >= inside.length_m) return std::nullopt;
  return SampleRun{.start = (inside.start + d * first_m) * 4.0F,
                   .step = d * (step_m * 4),
                   .count = static_cast<int>((inside.length_m - first_m) / step_m) + 1};
}
inline std::optional<SampleRun> sample_run(const GridFrame& frame, const PhotonSegment& segment) {
  const std::optional<IndexSegment> inside = clip(frame, segment);
  return inside ? sample_run(*inside, segment.jitter) : std::nullopt;
}

// What a deposit adds to a slot's moments and second moments, in coarse units, for one metre
// (track) or one crossing (face) of a segment; [function][rgb], then the second moment's rgb.
inline constexpr std::size_t max_lanes = 30;
struct SegmentLanes {
  std::array<float, max_lanes> values;  // the layout's lanes() of them
  std::size_t slot = 0;
};
SegmentLanes track_lanes(const DepositTarget& target, const V3f& w, const Rgb& power_lm);
// For a face of the given axis, divided by |cos| where the estimator asks for it.
SegmentLanes face_lanes(const DepositTarget& target, const V3f& w, const Rgb& power_lm, unsigned axis);

}  // namespace ivory
