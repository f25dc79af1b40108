// Photon segments into a grid's integer sums.
#pragma once

#include <cstdint>
#include <vector>

#include "grid/sums.h"
#include "tracer/photon_tracer.h"

namespace ivory {

// How `track` finds the cells that a segment passes. `sampled` is what bakes use; `exact` is its slow
// twin, kept for the tests and the bench.
enum class TrackWalk {
  sampled,  // one jittered position per slice of the dominant axis
  exact,    // cell by cell, with exact lengths
};

// The sums that all threads share. Integer addition commutes, so neither the order of the threads
// nor how the photons were cut into batches leaves a trace.
struct DepositTarget {
  GridFrame frame;
  Basis basis = Basis::vectors;
  Estimator estimator = Estimator::track;
  TrackWalk walk = TrackWalk::sampled;
  SumLayout layout;
  double quantum = 0;  // as in GridSums
  double quantum_squared = 0;
  std::vector<std::uint64_t> cell_masks;  // [vertex] 4x4x4 subcells that the vertex sees, x fastest; track only
  std::vector<std::int64_t> sums;         // [slot][vertex][lane]
};

// Sizes the sums and picks the quanta: a photon of `power_lm` (its strongest channel) crossing one
// voxel is 2^18 units, which leaves rounding far below the photon noise even for channels and
// direction components 10,000 times weaker. Throws Error where memory does not suffice.
DepositTarget make_deposit_target(const GridFrame& frame, Basis basis, Estimator estimator, float power_lm,
                                  std::vector<std::uint64_t> cell_masks);

// One thread's buffer: 32-bit sums that spill over into the shared 64-bit ones before they can overflow.
class PhotonDepositor {
 public:
  explicit PhotonDepositor(DepositTarget& target);
  void deposit(const std::vector<PhotonSegment>& segments);
  // Moves everything into the shared sums. To be called once a thread's last batch is in.
  void flush();

 private:
  struct Step;
  template <int lanes>
  void deposit_track_sampled(const std::vector<PhotonSegment>& segments);
  void deposit_track_exact(const std::vector<PhotonSegment>& segments);
  void deposit_face(const std::vector<PhotonSegment>& segments);
  void spill(std::size_t first_lane, int lanes);

  DepositTarget& target_;
  std::vector<std::int32_t> sums_;  // [slot][vertex][lane]
};

}  // namespace ivory
