#include "tracer/bake/field/deposit/photon_deposit.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "tracer/bake/field/deposit/huge_pages.h"
#include "tracer/bake/field/deposit/units.h"

// The track-length estimator. The irradiance vectors at a vertex are taken as the mean over its cell V
// (the box of one voxel around it, as far as the vertex sees it):
//
//   I_f = 1/|V| int_V int L(x, w) f(w) dw dx = 1/|V| sum over photons of power f(w) * (length inside V),
//
// because the density of photon path length per volume and solid angle, weighted by power, is L. It
// is unbiased for the cell's mean and bounded, whatever the angle to the cell's faces.
//
// `sampled` replaces "length inside V" by one position per step of s metres, at (u + j) s from the
// segment's entry, with one u a segment: each position counts s metres to the cell it falls in. Every
// point of the segment is hit with density 1/s, so the mean is the same. s is the segment's length
// in one slice of its dominant axis, so no cell is met by more than two positions.

namespace ivory {
namespace {

constexpr std::size_t line_lanes = 64 / sizeof(std::int32_t);

// How many segments are kept at most: as many in each octant as meet each of its cells several times. Bounded, as they
// take about 100 bytes each.
std::size_t most_kept(std::size_t vertices) {
  return std::clamp(2 * vertices, std::size_t(1) << 14, std::size_t(1) << 16);
}

}  // namespace

PhotonDepositor::PhotonDepositor(DepositTarget& target, TrackWalk walk)
    : target_(target),
      walk_(walk),
      cell_stride_(cell_lanes(std::size_t(target.layout.lanes()))),
      most_kept_(most_kept(target.cell_masks.size())) {
  coarse_.unit_bits = target.fine_bits;
  for (Scale* scale : {&coarse_, &fine_}) scale->runs.resize(std::size_t(target.lattice.levels()));
  if (target.buffers == DepositBuffers::shared) return;
  const std::size_t cells = target.cell_masks.size() * std::size_t(target.layout.slots);
  for (Scale* scale : {&coarse_, &fine_}) {
    if (scale == &fine_ && target.fine_bits == 0) continue;
    scale->sums.reserve(cells * cell_stride_ + line_lanes);
    ask_for_huge_pages(scale->sums.data(), scale->sums.capacity() * sizeof(std::int32_t));
    scale->sums.assign(cells * cell_stride_ + line_lanes, 0);
  }
}

double PhotonDepositor::most_kept_bytes(std::size_t vertices, int levels, const SumLayout& layout) {
  const std::size_t values = value_lanes(std::size_t(layout.lanes())) * sizeof(std::int32_t);
  // Vectors double as they grow.
  return 2 * double(most_kept(vertices)) * (double(sizeof(Run)) * levels + double(values));
}

std::int32_t* PhotonDepositor::Scale::cells() {
  const auto at = reinterpret_cast<std::uintptr_t>(sums.data()) / sizeof(std::int32_t) % line_lanes;
  return sums.data() + (line_lanes - at) % line_lanes;
}

std::int32_t* PhotonDepositor::cell(Scale& scale, std::size_t slot, std::size_t vertex) {
  return scale.cells() + (slot * target_.cell_masks.size() + vertex) * cell_stride_;
}

void PhotonDepositor::deposit(const std::vector<PhotonSegment>& segments) {
  switch (target_.layout.lanes()) {
    case 12:
      return deposit_all<12>(segments);
    case 15:
      return deposit_all<15>(segments);
    case 30:
      return deposit_all<30>(segments);
    default:
      assert(false);
  }
}

void PhotonDepositor::settle() {
  switch (target_.layout.lanes()) {
    case 12:
      return settle_all<12>();
    case 15:
      return settle_all<15>();
    case 30:
      return settle_all<30>();
    default:
      assert(false);
  }
}

template <int lanes>
void PhotonDepositor::deposit_all(const std::vector<PhotonSegment>& segments) {
  if (target_.estimator != Estimator::track) {
    for (const PhotonSegment& segment : segments) cross_faces(segment);
    return;
  }
  if (walk_ == TrackWalk::exact) {
    for (const PhotonSegment& segment : segments) {
      for (int level = 0; level < target_.lattice.levels(); ++level) walk_cells<lanes>(segment, level);
    }
    return;
  }
  const float fine_limit = fine_below(target_.fine_bits);
  const Lattice& lattice = target_.lattice;
  constexpr std::size_t padded = value_lanes(lanes);
  // Sorted by slot, so that the inner loop works on an eighth of the sums at a time.
  for (const PhotonSegment& segment : segments) {
    // What a step adds is the same number in all levels: each halves the step and the unit.
    std::array<float, lanes> values;
    SegmentLanes a_metre;
    Scale* scale = nullptr;
    bool is_known = false;
    for (int level = 0; level < lattice.levels(); ++level) {
      const std::optional<IndexSegment> inside = clip(lattice.frame_of(level), segment);
      if (!inside) continue;
      const std::optional<SampleRun> run = sample_run(*inside, segment.jitter);
      if (!run) continue;
      if (!is_known) {
        is_known = true;
        a_metre = track_lanes(target_, inside->w, segment.power_lm);
        const float step_m = std::ldexp(sample_step_m(*inside), level);
        float largest = 0;
        for (std::size_t i = 0; i < lanes; ++i) {
          values[i] = a_metre.values[i] * (i + 3 < lanes ? step_m : step_m * step_m);
          largest = std::max(largest, std::abs(values[i]));
        }
        const bool is_fine = largest < fine_limit;
        scale = !(largest < largest_step) ? nullptr : is_fine ? &fine_ : &coarse_;
        if (scale != nullptr) {
          std::vector<std::int32_t>& integers = scale->run_values[a_metre.slot];
          integers.resize(integers.size() + padded);
          std::int32_t* const own = integers.data() + integers.size() - padded;
          if (is_fine) {
            const std::uint32_t key = rounding_key(segment);
            for (std::size_t i = 0; i < lanes; ++i) own[i] = rounded_at_random(values[i], target_.fine_bits, key, i);
          } else {
            for (std::size_t i = 0; i < lanes; ++i) own[i] = rounded(values[i]);
          }
          ++kept_;
        }
      }
      if (scale != nullptr) {
        const auto value = std::uint32_t(scale->run_values[a_metre.slot].size() / padded - 1);
        scale->runs[std::size_t(level)][a_metre.slot].push_back({*run, value});
        continue;
      }
      const auto add_wide_at = [&](std::uint32_t vertex, unsigned bit) {
        if (((target_.cell_masks[vertex] >> bit) & 1U) != 0) add_wide(a_metre.slot, vertex, values.data(), lanes);
      };
      if (level == 0) {
        for_each_sample(lattice.frame, *run, add_wide_at, [] {});
      } else {
        for_each_sample(lattice.finer[std::size_t(level - 1)], *run, add_wide_at, [] {});
      }
    }
  }
  if (kept_ >= most_kept_) settle_all<lanes>();
}

template <int lanes>
void PhotonDepositor::settle_all() {
  if (kept_ == 0) return;
  kept_ = 0;
  for (Scale* scale : {&coarse_, &fine_}) {
    for (std::size_t slot = 0; slot < scale->run_values.size(); ++slot) {
      if (scale->run_values[slot].empty()) continue;
      sample_runs<lanes>(*scale, slot);
      for (Runs& runs : scale->runs) runs[slot].clear();
      scale->run_values[slot].clear();
    }
  }
}

template <int lanes>
void PhotonDepositor::sample_runs(Scale& scale, std::size_t slot) {
  const Lattice& lattice = target_.lattice;
  const bool shared = target_.buffers == DepositBuffers::shared;
  const auto add_level = [&](std::size_t index, const auto& level) {
    const std::vector<Run>& runs = scale.runs[index][slot];
    if (runs.empty()) return;
    if (shared) {
      add_runs<lanes, true>(scale, slot, runs, level);
    } else {
      add_runs<lanes, false>(scale, slot, runs, level);
    }
  };
  add_level(0, lattice.frame);
  for (std::size_t i = 0; i < lattice.finer.size(); ++i) add_level(i + 1, lattice.finer[i]);
}

// The sums of an octant outgrow the second-level cache from about 32^3 vertices on, and then this is bound by memory
// latency: positions are found ahead of time and their sums asked for, then added when they are there.
template <int lanes, bool shared, typename Level>
void PhotonDepositor::add_runs(Scale& scale, std::size_t slot, const std::vector<Run>& runs, const Level& level) {
  const std::uint64_t* masks = target_.cell_masks.data();
  const std::int32_t* values = scale.run_values[slot].data();
  std::int32_t* own = shared ? nullptr : cell(scale, slot, 0);
  std::int64_t* all = target_.sums.data() + target_.lane_index(slot, 0);
  const std::size_t all_stride = target_.lane_index(0, 1);
  constexpr std::size_t own_stride = cell_lanes(lanes);

  struct Pending {
    std::uint32_t vertex;
    std::uint32_t value;
  };
  constexpr std::size_t ahead = 48;
  static_assert(ahead + sample_block <= steps_between_checks);
  std::array<Pending, ahead + sample_block> pending;
  std::size_t waiting = 0;
  const auto add_pending = [&] {
    CellAdder<lanes> adder;
    for (std::size_t i = 0; i < waiting; ++i) {
      const Pending& p = pending[i];
      const std::int32_t* value = values + std::size_t(p.value) * value_lanes(lanes);
      if constexpr (shared) {
        add_shared<lanes>(all + p.vertex * all_stride, value, scale.unit_bits);
      } else {
        adder.add(own + p.vertex * own_stride, value);
      }
    }
    if (!shared && adder.passed_limit()) {
      for (std::size_t i = 0; i < waiting; ++i) {
        if (is_past_limit(own + pending[i].vertex * own_stride, lanes)) spill(scale, slot, pending[i].vertex);
      }
    }
    waiting = 0;
  };
  for (const Run& run : runs) {
    for_each_sample(
        level, run,
        [&](std::uint32_t vertex, unsigned bit) {
          // Kept whether seen or not, counted only if seen: a branch here would be mispredicted often.
          const char* line = shared ? reinterpret_cast<const char*>(all + vertex * all_stride)
                                    : reinterpret_cast<const char*>(own + vertex * own_stride);
          constexpr std::size_t bytes = shared ? lanes * sizeof(std::int64_t) : own_stride * sizeof(std::int32_t);
          __builtin_prefetch(line, 1);
          if constexpr (bytes > 64) __builtin_prefetch(line + (shared ? bytes / 2 : 64), 1);
          if constexpr (shared) __builtin_prefetch(line + bytes - 1, 1);
          pending[waiting] = {vertex, run.value};
          waiting += (masks[vertex] >> bit) & 1U;
        },
        [&] {
          if (waiting >= ahead) add_pending();
        });
  }
  add_pending();
}

// Saturates instead of overflowing: a deposit of 2^60 units (a face met at next to no angle) is noise
// whatever is done with it, but must not be undefined.
void PhotonDepositor::add_wide(std::size_t slot, std::size_t vertex, const float* values, int lanes) {
  const double unit = std::ldexp(1.0, coarse_.unit_bits);
  std::array<std::int64_t, max_lanes> wide{};
  for (std::size_t i = 0; i < std::size_t(lanes); ++i)
    wide[i] = std::isnan(values[i]) ? 0 : std::llround(std::clamp(double(values[i]) * unit, -0x1p60, 0x1p60));
  std::int64_t* sums = target_.sums.data() + target_.lane_index(slot, vertex);
  if (target_.buffers == DepositBuffers::shared) {
    const std::int64_t first = take(sums[0]);
    for (std::size_t i = 1; i < std::size_t(lanes); ++i) sums[i] += wide[i];
    put_back(sums[0], first + wide[0]);
  } else {
    for (std::size_t i = 0; i < std::size_t(lanes); ++i) atomic_add(sums[i], wide[i]);
  }
}

void PhotonDepositor::spill(Scale& scale, std::size_t slot, std::size_t vertex) {
  std::int32_t* const own = cell(scale, slot, vertex);
  const std::size_t first = target_.lane_index(slot, vertex);
  for (std::size_t i = 0; i < std::size_t(target_.layout.lanes()); ++i) {
    if (own[i] != 0) atomic_add(target_.sums[first + i], std::int64_t(own[i]) << scale.unit_bits);
    own[i] = 0;
  }
}

void PhotonDepositor::flush() {
  settle();
  for (Scale* scale : {&coarse_, &fine_}) {
    if (scale->sums.empty()) continue;
    for (std::size_t slot = 0; slot < std::size_t(target_.layout.slots); ++slot) {
      for (std::size_t vertex = 0; vertex < target_.cell_masks.size(); ++vertex) spill(*scale, slot, vertex);
    }
  }
}

}  // namespace ivory
