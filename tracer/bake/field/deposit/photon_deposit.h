// Photon segments into a grid's integer sums.
#pragma once

#include <cstdint>
#include <vector>

#include "tracer/bake/field/deposit/target.h"

namespace ivory {

// How `track` finds the cells that a segment passes. Bakes use `sampled`; `exact` is its twin without
// sampling noise, for the tests and the bench.
enum class TrackWalk {
  sampled,  // one jittered position per slice of the dominant axis
  exact,    // cell by cell, with exact lengths
};

// What one thread adds. With DepositBuffers::own it has 32-bit sums that spill over into the shared 64-bit ones before
// they can overflow.
class PhotonDepositor {
 public:
  // `target` must outlive this object; several depositors may share it.
  explicit PhotonDepositor(DepositTarget& target, TrackWalk walk = TrackWalk::sampled);
  // Segments are kept until there are enough of each octant to work on its sums alone, which then stay in the cache.
  void deposit(const std::vector<PhotonSegment>& segments);
  // Adds those that are kept.
  void settle();
  // Moves everything into the shared sums. To be called once the thread's last batch is in.
  void flush();

  // Bytes that one depositor takes at most besides its own sums: what it keeps of segments.
  static double most_kept_bytes(std::size_t vertices, int levels, const SumLayout& layout);

 private:
  // Steps through a level, and what each of them adds: one of run_values.
  struct Run : SampleRun {
    std::uint32_t value = 0;
  };
  using Runs = std::array<std::vector<Run>, 8>;  // [slot]

  // Sums of one size of unit. Photons are added to one of two, so that 32 bits suffice for either.
  struct Scale {
    int unit_bits = 0;                                    // a unit is 2^unit_bits quanta
    std::vector<std::int32_t> sums;                       // see cells(); empty where they are shared
    std::vector<Runs> runs;                               // [level], kept
    std::array<std::vector<std::int32_t>, 8> run_values;  // [slot][value][lane, padded]

    // [slot][vertex][lane, padded], from a cache line's start on.
    std::int32_t* cells();
  };

  template <int lanes>
  void deposit_all(const std::vector<PhotonSegment>& segments);
  template <int lanes>
  void settle_all();
  template <int lanes>
  void sample_runs(Scale& scale, std::size_t slot);
  template <int lanes, bool shared, typename Level>
  void add_runs(Scale& scale, std::size_t slot, const std::vector<Run>& runs, const Level& level);
  template <int lanes>
  void walk_cells(const PhotonSegment& segment, int level);
  void cross_faces(const PhotonSegment& segment);
  template <int lanes>
  void add_step(std::size_t slot, std::size_t vertex, const float* values, const PhotonSegment& segment);
  void add_wide(std::size_t slot, std::size_t vertex, const float* values, int lanes);
  std::int32_t* cell(Scale& scale, std::size_t slot, std::size_t vertex);
  void spill(Scale& scale, std::size_t slot, std::size_t vertex);

  DepositTarget& target_;
  TrackWalk walk_;
  std::size_t cell_stride_;
  std::size_t kept_ = 0;  // segments
  std::size_t most_kept_;
  Scale coarse_;
  Scale fine_;  // empty where the target has no fine bits
};

}  // namespace ivory
