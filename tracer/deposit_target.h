// Where photon deposits go: the integer sums that all threads share, and a segment's place in the grid.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "grid/sums.h"
#include "tracer/photon_tracer.h"

namespace ivory {

// Integer addition commutes, so neither the order of the threads nor how the photons were cut into
// batches leaves a trace in the sums.
struct DepositTarget {
  GridFrame frame;
  Basis basis = Basis::vectors;
  Estimator estimator = Estimator::track;
  SumLayout layout;
  double quantum = 0;  // as in GridSums
  double quantum_squared = 0;
  std::vector<std::uint64_t> cell_masks;  // [vertex] 4x4x4 subcells that the vertex sees, x fastest; track only
  std::vector<std::int64_t> sums;         // [slot][vertex][lane]

  std::size_t lane_index(std::size_t slot, std::size_t vertex) const {
    return (slot * cell_masks.size() + vertex) * std::size_t(layout.lanes());
  }
};

// Sizes the sums and picks the quanta: a photon of `power_lm` (its strongest channel) crossing one voxel
// is 2^18 units, which leaves rounding far below the photon noise even for channels and direction
// components 10,000 times weaker.
DepositTarget make_deposit_target(const GridFrame& frame, Basis basis, Estimator estimator, float power_lm,
                                  std::vector<std::uint64_t> cell_masks);

// The sums as a GridSums keeps them, [vertex][slot][lane].
std::vector<std::int64_t> sums_by_vertex(const DepositTarget& target);

// The part of a segment inside the grid's box, in index coordinates shifted by one half: vertex i's cell
// is [i, i + 1).
struct IndexSegment {
  V3f start;
  V3f per_metre;
  float length_m = 0;
  V3f w;  // in the grid's own axes, towards the light
};
std::optional<IndexSegment> clip(const GridFrame& frame, const PhotonSegment& segment);

// What a deposit adds to a slot's moments and second moments, in units of the quanta, for one metre
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
