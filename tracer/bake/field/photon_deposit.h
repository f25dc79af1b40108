// Photon segments into a grid's integer sums.
#pragma once

#include <cstdint>
#include <vector>

#include "tracer/bake/field/deposit_target.h"

namespace ivory {

// How `track` finds the cells that a segment passes. Bakes use `sampled`; `exact` is its twin without
// sampling noise, for the tests and the bench.
enum class TrackWalk {
  sampled,  // one jittered position per slice of the dominant axis
  exact,    // cell by cell, with exact lengths
};

// One thread's buffer: 32-bit sums that spill over into the shared 64-bit ones before they can overflow.
class PhotonDepositor {
 public:
  // `target` must outlive this object; several depositors may share it.
  explicit PhotonDepositor(DepositTarget& target, TrackWalk walk = TrackWalk::sampled);
  void deposit(const std::vector<PhotonSegment>& segments);
  // Moves everything into the shared sums. To be called once the thread's last batch is in.
  void flush();

 private:
  // Equal steps through the grid, and what each of them adds (in run_values_).
  struct Run {
    V3f start;  // quarters of a voxel
    V3f step;
    int count = 0;
  };

  // Sums of one size of unit. Photons are added to one of two, so that 32 bits suffice for either.
  struct Scale {
    std::int64_t unit = 1;                                // in quanta
    std::vector<std::int32_t> sums;                       // [slot][vertex][lane]
    std::array<std::vector<Run>, 8> runs;                 // [slot], scratch
    std::array<std::vector<std::int32_t>, 8> run_values;  // [slot][run][lane]
  };

  template <int lanes>
  void deposit_all(const std::vector<PhotonSegment>& segments);
  template <int lanes>
  void sample_runs(Scale& scale, std::size_t slot);
  template <int lanes>
  void walk_cells(const PhotonSegment& segment);
  void cross_faces(const PhotonSegment& segment);
  template <int lanes>
  void add_step(std::size_t slot, std::size_t vertex, const float* values, const PhotonSegment& segment);
  void add_wide(std::size_t slot, std::size_t vertex, const float* values, int lanes);
  void spill(Scale& scale, std::size_t first_lane, int lanes);

  DepositTarget& target_;
  TrackWalk walk_;
  Scale coarse_;
  Scale fine_;  // empty where the target has no fine bits
};

}  // namespace ivory
