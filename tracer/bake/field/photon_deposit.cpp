#include "tracer/bake/field/photon_deposit.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>

#include "tracer/bake/field/deposit_units.h"

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
//
// The face estimators of RR-6983 section 3.3 add power w (face_paper) or power w / |cos| (face) where
// a segment crosses a voxel face, to the nearest of the face's vertices, and divide by the face's area.
// Here every vertex stands in the middle of a whole cell, so the paper's half and quarter areas at the
// grid's border do not arise.

namespace ivory {
namespace {

void atomic_add(std::int64_t& target, std::int64_t value) {
  std::atomic_ref<std::int64_t>(target).fetch_add(value, std::memory_order_relaxed);
}

// Subcell bit within a cell, from a position in quarters of a voxel.
unsigned subcell(int x, int y, int z) { return static_cast<unsigned>(((z & 3) << 4) | ((y & 3) << 2) | (x & 3)); }

}  // namespace

PhotonDepositor::PhotonDepositor(DepositTarget& target, TrackWalk walk) : target_(target), walk_(walk) {
  coarse_.unit = std::int64_t(1) << target.fine_bits;
  coarse_.sums.assign(target.sums.size(), 0);
  if (target.fine_bits != 0) fine_.sums.assign(target.sums.size(), 0);
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

template <int lanes>
void PhotonDepositor::deposit_all(const std::vector<PhotonSegment>& segments) {
  if (target_.estimator != Estimator::track) {
    for (const PhotonSegment& segment : segments) cross_faces(segment);
    return;
  }
  if (walk_ == TrackWalk::exact) {
    for (const PhotonSegment& segment : segments) walk_cells<lanes>(segment);
    return;
  }
  const float fine_limit = fine_below(target_.fine_bits);
  // Sorted by slot, so that the inner loop works on an eighth of the sums at a time.
  for (const PhotonSegment& segment : segments) {
    const std::optional<IndexSegment> inside = clip(target_.frame, segment);
    if (!inside) continue;
    const V3f& d = inside->per_metre;
    const float step_m = 1 / std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    const float first_m = segment.jitter * step_m;
    if (first_m >= inside->length_m) continue;
    const SegmentLanes a_metre = track_lanes(target_, inside->w, segment.power_lm);
    Run run;
    run.count = static_cast<int>((inside->length_m - first_m) / step_m) + 1;
    run.start = (inside->start + d * first_m) * 4.0F;
    run.step = d * (step_m * 4);
    std::array<float, lanes> values;
    float largest = 0;
    for (std::size_t i = 0; i < lanes; ++i) {
      values[i] = a_metre.values[i] * (i + 3 < lanes ? step_m : step_m * step_m);
      largest = std::max(largest, std::abs(values[i]));
    }
    if (largest < largest_step) {
      const bool is_fine = largest < fine_limit;
      Scale& scale = is_fine ? fine_ : coarse_;
      scale.runs[a_metre.slot].push_back(run);
      std::vector<std::int32_t>& integers = scale.run_values[a_metre.slot];
      integers.resize(integers.size() + lanes);
      if (is_fine) {
        const std::uint32_t key = rounding_key(segment);
        for (std::size_t i = 0; i < lanes; ++i)
          integers[integers.size() - lanes + i] = rounded_at_random(values[i], target_.fine_bits, key, i);
      } else {
        std::transform(values.begin(), values.end(), integers.end() - lanes, rounded);
      }
      continue;
    }
    for (int j = 0; j < run.count; ++j) {
      const V3f p = run.start + run.step * static_cast<float>(j);
      const V3i quarter(static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z));
      V3i cell;
      for (unsigned axis = 0; axis < 3; ++axis)
        cell[axis] = std::clamp(quarter[axis] >> 2, 0, target_.frame.size[axis] - 1);
      const std::size_t vertex = target_.frame.vertex_index(cell.x, cell.y, cell.z);
      if (((target_.cell_masks[vertex] >> subcell(quarter.x, quarter.y, quarter.z)) & 1U) != 0)
        add_wide(a_metre.slot, vertex, values.data(), lanes);
    }
  }
  for (Scale* scale : {&coarse_, &fine_}) {
    for (std::size_t slot = 0; slot < scale->runs.size(); ++slot) {
      sample_runs<lanes>(*scale, slot);
      scale->runs[slot].clear();
      scale->run_values[slot].clear();
    }
  }
}

// The sums outgrow the second-level cache from about 32^3 vertices on, so this is bound by memory
// latency: positions are found ahead of time and their sums asked for, then added when they are there.
template <int lanes>
void PhotonDepositor::sample_runs(Scale& scale, std::size_t slot) {
  if (scale.runs[slot].empty()) return;
  const V3i last = target_.frame.size - V3i(1, 1, 1);
  const int row = target_.frame.size.x;
  const int plane = row * target_.frame.size.y;
  const std::uint64_t* masks = target_.cell_masks.data();
  std::int32_t* sums = scale.sums.data() + target_.lane_index(slot, 0);

  struct Pending {
    std::uint32_t vertex;
    std::uint32_t run;
  };
  constexpr std::size_t ahead = 48;
  constexpr int block = 8;  // positions found at once: that part vectorises
  std::array<Pending, ahead + block> pending;
  std::size_t waiting = 0;
  const auto add_pending = [&] {
    for (std::size_t i = 0; i < waiting; ++i) {
      const Pending& p = pending[i];
      std::int32_t* cell = sums + std::size_t(p.vertex) * lanes;
      if (add<lanes>(cell, scale.run_values[slot].data() + std::size_t(p.run) * lanes))
        spill(scale, target_.lane_index(slot, p.vertex), lanes);
    }
    waiting = 0;
  };

  for (std::size_t r = 0; r < scale.runs[slot].size(); ++r) {
    const Run& run = scale.runs[slot][r];
    std::array<std::int32_t, block> vertex;
    std::array<std::int32_t, block> bit;
    for (int first = 0; first < run.count; first += block) {
      for (int k = 0; k < block; ++k) {
        const auto j = static_cast<float>(first + k);
        const int x = static_cast<int>(run.start.x + run.step.x * j);
        const int y = static_cast<int>(run.start.y + run.step.y * j);
        const int z = static_cast<int>(run.start.z + run.step.z * j);
        const int cell_x = std::min(std::max(x >> 2, 0), last.x);
        const int cell_y = std::min(std::max(y >> 2, 0), last.y);
        const int cell_z = std::min(std::max(z >> 2, 0), last.z);
        vertex[std::size_t(k)] = cell_z * plane + cell_y * row + cell_x;
        bit[std::size_t(k)] = ((z & 3) << 4) | ((y & 3) << 2) | (x & 3);
      }
      const int used = std::min(block, run.count - first);
      for (int k = 0; k < used; ++k) {
        const auto v = static_cast<std::uint32_t>(vertex[std::size_t(k)]);
        // Kept whether seen or not, counted only if seen: a branch here would be mispredicted often.
        const char* line = reinterpret_cast<const char*>(sums + std::size_t(v) * lanes);
        __builtin_prefetch(line, 1);
        __builtin_prefetch(line + lanes * sizeof(std::int32_t) - 1, 1);
        pending[waiting] = {v, static_cast<std::uint32_t>(r)};
        waiting += (masks[v] >> static_cast<unsigned>(bit[std::size_t(k)])) & 1U;
      }
      if (waiting >= ahead) add_pending();
    }
  }
  add_pending();
}

// Whole cells are stepped through exactly; a cell that its vertex does not see whole is stepped
// through by its quarters, and only the visible ones count.
template <int lanes>
void PhotonDepositor::walk_cells(const PhotonSegment& segment) {
  const std::optional<IndexSegment> inside = clip(target_.frame, segment);
  if (!inside) return;
  const SegmentLanes a_metre = track_lanes(target_, inside->w, segment.power_lm);
  const V3f& d = inside->per_metre;
  constexpr float never = std::numeric_limits<float>::infinity();

  // Calls visit(cell, from_m, to_m) for each box of 1/scale voxels that [from_m, to_m] passes.
  const auto walk = [&](int scale, float from_m, float to_m, const V3i& least, const V3i& most, const auto& visit) {
    V3i at;
    V3f next_m;
    V3f stride_m;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const float speed = d[axis] * static_cast<float>(scale);
      const float x = inside->start[axis] * static_cast<float>(scale);
      at[axis] = std::clamp(static_cast<int>(x + speed * from_m), least[axis], most[axis]);
      stride_m[axis] = speed == 0 ? never : 1 / std::abs(speed);
      next_m[axis] = speed == 0 ? never : (static_cast<float>(at[axis] + (speed > 0 ? 1 : 0)) - x) / speed;
    }
    float t = from_m;
    while (t < to_m) {
      const unsigned axis = next_m.x <= next_m.y ? (next_m.x <= next_m.z ? 0U : 2U) : (next_m.y <= next_m.z ? 1U : 2U);
      const float end = std::min(next_m[axis], to_m);
      if (end > t) visit(at, t, end);
      t = std::max(t, end);
      next_m[axis] += stride_m[axis];
      at[axis] += d[axis] > 0 ? 1 : -1;
      if (at[axis] < least[axis] || at[axis] > most[axis]) break;
    }
  };

  walk(1, 0, inside->length_m, V3i(0, 0, 0), target_.frame.size - V3i(1, 1, 1),
       [&](const V3i& cell, float from_m, float to_m) {
         const std::size_t vertex = target_.frame.vertex_index(cell.x, cell.y, cell.z);
         const std::uint64_t mask = target_.cell_masks[vertex];
         float length_m = to_m - from_m;
         if (~mask != 0) {
           length_m = 0;
           walk(4, from_m, to_m, cell * 4, cell * 4 + V3i(3, 3, 3), [&](const V3i& quarter, float from, float to) {
             if (((mask >> subcell(quarter.x, quarter.y, quarter.z)) & 1U) != 0) length_m += to - from;
           });
         }
         if (length_m <= 0) return;
         std::array<float, lanes> values;
         for (std::size_t i = 0; i < lanes; ++i)
           values[i] = a_metre.values[i] * (i + 3 < lanes ? length_m : length_m * length_m);
         add_step<lanes>(a_metre.slot, vertex, values.data(), segment);
       });
}

void PhotonDepositor::cross_faces(const PhotonSegment& segment) {
  const V3i size = target_.frame.size;
  const std::optional<IndexSegment> inside = clip(target_.frame, segment);
  if (!inside) return;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const float speed = inside->per_metre[axis];
    if (speed == 0) continue;
    const SegmentLanes a_crossing = face_lanes(target_, inside->w, segment.power_lm, axis);
    // Faces lie at whole index coordinates, which are halves in the shifted ones.
    const float from = inside->start[axis] - 0.5F;
    const float to = from + speed * inside->length_m;
    const int first = std::max(static_cast<int>(std::ceil(std::min(from, to))), 0);
    const int last = std::min(static_cast<int>(std::floor(std::max(from, to))), size[axis] - 1);
    for (int plane = first; plane <= last; ++plane) {
      const V3f at = inside->start + inside->per_metre * ((static_cast<float>(plane) - from) / speed);
      V3i vertex;
      for (unsigned a = 0; a < 3; ++a) vertex[a] = std::clamp(static_cast<int>(at[a]), 0, size[a] - 1);
      vertex[axis] = plane;
      add_step<12>(a_crossing.slot, target_.frame.vertex_index(vertex.x, vertex.y, vertex.z), a_crossing.values.data(),
                   segment);
    }
  }
}

template <int lanes>
void PhotonDepositor::add_step(std::size_t slot, std::size_t vertex, const float* values,
                               const PhotonSegment& segment) {
  std::array<std::int32_t, lanes> integers;
  float largest = 0;
  for (std::size_t i = 0; i < lanes; ++i) largest = std::max(largest, std::abs(values[i]));
  if (!(largest < largest_step)) return add_wide(slot, vertex, values, lanes);
  const std::size_t first = target_.lane_index(slot, vertex);
  Scale& scale = largest < fine_below(target_.fine_bits) ? fine_ : coarse_;
  if (&scale == &fine_) {
    const std::uint32_t key = mixed(rounding_key(segment) ^ static_cast<std::uint32_t>(first));
    for (std::size_t i = 0; i < lanes; ++i) integers[i] = rounded_at_random(values[i], target_.fine_bits, key, i);
  } else {
    for (std::size_t i = 0; i < lanes; ++i) integers[i] = rounded(values[i]);
  }
  if (add<lanes>(scale.sums.data() + first, integers.data())) spill(scale, first, lanes);
}

// Saturates instead of overflowing: a deposit of 2^60 units (a face met at next to no angle) is noise
// whatever is done with it, but must not be undefined.
void PhotonDepositor::add_wide(std::size_t slot, std::size_t vertex, const float* values, int lanes) {
  const std::size_t first = target_.lane_index(slot, vertex);
  for (std::size_t i = 0; i < std::size_t(lanes); ++i) {
    const double value =
        std::isnan(values[i]) ? 0 : std::clamp(double(values[i]) * double(coarse_.unit), -0x1p60, 0x1p60);
    atomic_add(target_.sums[first + i], std::llround(value));
  }
}

void PhotonDepositor::spill(Scale& scale, std::size_t first_lane, int lanes) {
  for (std::size_t i = first_lane; i < first_lane + std::size_t(lanes); ++i) {
    atomic_add(target_.sums[i], scale.sums[i] * scale.unit);
    scale.sums[i] = 0;
  }
}

void PhotonDepositor::flush() {
  for (Scale* scale : {&coarse_, &fine_}) {
    for (std::size_t i = 0; i < scale->sums.size(); ++i) {
      if (scale->sums[i] != 0) atomic_add(target_.sums[i], scale->sums[i] * scale->unit);
    }
    std::fill(scale->sums.begin(), scale->sums.end(), 0);
  }
}

}  // namespace ivory
