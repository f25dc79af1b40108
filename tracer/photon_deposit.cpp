#include "tracer/photon_deposit.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "grid/error.h"

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

constexpr std::int32_t spill_limit = 1 << 30;
constexpr std::int32_t largest_step = 1 << 24;  // larger deposits go to the shared sums at once

// A segment in index coordinates shifted by one half: vertex i's cell is [i, i + 1).
struct IndexSegment {
  V3f start;
  V3f per_metre;
  float length_m;
};

// Clips to the grid's box: 0 to size in shifted coordinates.
std::optional<IndexSegment> clip(const GridFrame& frame, const PhotonSegment& segment) {
  const V3f origin = frame.to_index(segment.origin) + V3f(0.5F, 0.5F, 0.5F);
  const V3f direction = frame.direction_to_local(segment.direction) / frame.spacing_m;
  float t0 = 0;
  float t1 = segment.length_m;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const float last = static_cast<float>(frame.size[axis]);
    if (direction[axis] == 0) {
      if (origin[axis] < 0 || origin[axis] > last) return std::nullopt;
      continue;
    }
    const float inverse = 1 / direction[axis];
    const float near = (direction[axis] > 0 ? -origin[axis] : last - origin[axis]) * inverse;
    const float far = (direction[axis] > 0 ? last - origin[axis] : -origin[axis]) * inverse;
    t0 = std::max(t0, near);
    t1 = std::min(t1, far);
  }
  if (!(t1 > t0)) return std::nullopt;
  return IndexSegment{origin + direction * t0, direction, t1 - t0};
}

std::size_t octant_of(const V3f& w) { return (w.x < 0 ? 1U : 0U) | (w.y < 0 ? 2U : 0U) | (w.z < 0 ? 4U : 0U); }

void atomic_add(std::int64_t& target, std::int64_t value) {
  std::atomic_ref<std::int64_t>(target).fetch_add(value, std::memory_order_relaxed);
}

// The values that one step adds: moments and second moments in units of the quanta.
constexpr std::size_t max_lanes = 30;
using Lanes = std::array<double, max_lanes>;

Lanes lanes_of(const DepositTarget& target, const PhotonSegment& segment, double measure) {
  const V3f w = target.frame.direction_to_local(-segment.direction);
  std::array<float, max_functions> functions{};
  if (target.estimator == Estimator::track && target.layout.slots == 1) {
    functions = eval(target.basis, w);
  } else if (target.estimator == Estimator::track) {
    functions = {std::abs(w.x), std::abs(w.y), std::abs(w.z)};
  } else {
    functions = {w.x, w.y, w.z};
  }
  Lanes lanes{};
  const auto count = std::size_t(target.layout.functions);
  for (std::size_t c = 0; c < 3; ++c) {
    const double flux = double(segment.power_lm[unsigned(c)]) * measure;
    for (std::size_t f = 0; f < count; ++f) lanes[3 * f + c] = flux * double(functions[f]) / target.quantum;
    lanes[3 * count + c] = flux * flux / target.quantum_squared;
  }
  return lanes;
}

bool fits(const Lanes& lanes) {
  return std::all_of(lanes.begin(), lanes.end(), [](double v) { return std::abs(v) < largest_step; });
}

// Saturates instead of overflowing: a deposit of 2^62 units is garbage anyway (a face crossed at zero
// angle), but it must not be undefined.
std::int64_t rounded(double value) { return std::llround(std::clamp(value, -0x1p62, 0x1p62)); }

}  // namespace

DepositTarget make_deposit_target(const GridFrame& frame, Basis basis, Estimator estimator, float power_lm,
                                  std::vector<std::uint64_t> cell_masks) {
  DepositTarget target;
  target.frame = frame;
  target.basis = basis;
  target.estimator = estimator;
  target.layout = sum_layout(basis, estimator);
  const double mean_spacing_m = (double(frame.spacing_m.x) + frame.spacing_m.y + frame.spacing_m.z) / 3;
  const double unit = double(power_lm) * (estimator == Estimator::track ? mean_spacing_m : 1.0);
  target.quantum = unit * 0x1p-18;
  target.quantum_squared = unit * unit * 0x1p-18;
  target.cell_masks = std::move(cell_masks);
  assert(target.cell_masks.size() == frame.vertex_count());
  target.sums.assign(frame.vertex_count() * std::size_t(target.layout.stride()), 0);
  return target;
}

PhotonDepositor::PhotonDepositor(DepositTarget& target) : target_(target), sums_(target.sums.size(), 0) {}

void PhotonDepositor::deposit(const std::vector<PhotonSegment>& segments) {
  if (target_.estimator != Estimator::track) return deposit_face(segments);
  if (target_.walk == TrackWalk::exact) return deposit_track_exact(segments);
  switch (target_.layout.lanes()) {
    case 12:
      return deposit_track_sampled<12>(segments);
    case 15:
      return deposit_track_sampled<15>(segments);
    case 30:
      return deposit_track_sampled<30>(segments);
    default:
      assert(false);
  }
}

// A run of equal steps through the grid, ready for the inner loop: positions in quarters of a voxel.
struct PhotonDepositor::Step {
  V3f start;
  V3f step;
  int count = 0;
  std::array<std::int32_t, max_lanes> values;
};

template <int lanes>
void PhotonDepositor::deposit_track_sampled(const std::vector<PhotonSegment>& segments) {
  // Sorted by octant, so that the inner loop works on an eighth of the sums at a time.
  std::array<std::vector<Step>, 8> steps;
  for (const PhotonSegment& segment : segments) {
    const std::optional<IndexSegment> inside = clip(target_.frame, segment);
    if (!inside) continue;
    const V3f& d = inside->per_metre;
    const float step_m = 1 / std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    const float first_m = segment.jitter * step_m;
    if (first_m >= inside->length_m) continue;
    Step step;
    step.count = static_cast<int>((inside->length_m - first_m) / step_m) + 1;
    step.start = (inside->start + d * first_m) * 4.0F;
    step.step = d * (step_m * 4);
    const Lanes values = lanes_of(target_, segment, step_m);
    const std::size_t slot =
        target_.layout.slots == 8 ? octant_of(target_.frame.direction_to_local(-segment.direction)) : 0;
    if (fits(values)) {
      for (std::size_t i = 0; i < lanes; ++i) step.values[i] = static_cast<std::int32_t>(std::lrint(values[i]));
      steps[slot].push_back(step);
      continue;
    }
    for (int j = 0; j < step.count; ++j) {
      const V3f p = step.start + step.step * float(j);
      const V3i quarter(int(p.x), int(p.y), int(p.z));
      const std::size_t vertex = target_.frame.vertex_index(std::clamp(quarter.x >> 2, 0, target_.frame.size.x - 1),
                                                            std::clamp(quarter.y >> 2, 0, target_.frame.size.y - 1),
                                                            std::clamp(quarter.z >> 2, 0, target_.frame.size.z - 1));
      const int bit = ((quarter.z & 3) << 4) | ((quarter.y & 3) << 2) | (quarter.x & 3);
      if (((target_.cell_masks[vertex] >> unsigned(bit)) & 1U) == 0) continue;
      for (std::size_t i = 0; i < lanes; ++i)
        atomic_add(target_.sums[(slot * target_.cell_masks.size() + vertex) * lanes + i], rounded(values[i]));
    }
  }

  const V3i last = target_.frame.size - V3i(1, 1, 1);
  const int row = target_.frame.size.x;
  const int plane = row * target_.frame.size.y;
  const std::uint64_t* masks = target_.cell_masks.data();
  for (std::size_t slot = 0; slot < 8; ++slot) {
    std::int32_t* sums = sums_.data() + slot * target_.cell_masks.size() * lanes;
    for (const Step& step : steps[slot]) {
      // Cells and subcells of a block of positions at once: this part vectorises.
      constexpr int block = 8;
      std::array<std::int32_t, block> vertex;
      std::array<std::int32_t, block> bit;
      for (int first = 0; first < step.count; first += block) {
        for (int k = 0; k < block; ++k) {
          const auto j = static_cast<float>(first + k);
          const int x = static_cast<int>(step.start.x + step.step.x * j);
          const int y = static_cast<int>(step.start.y + step.step.y * j);
          const int z = static_cast<int>(step.start.z + step.step.z * j);
          const int cell_x = std::min(std::max(x >> 2, 0), last.x);
          const int cell_y = std::min(std::max(y >> 2, 0), last.y);
          const int cell_z = std::min(std::max(z >> 2, 0), last.z);
          vertex[std::size_t(k)] = cell_z * plane + cell_y * row + cell_x;
          bit[std::size_t(k)] = ((z & 3) << 4) | ((y & 3) << 2) | (x & 3);
        }
        const int used = std::min(block, step.count - first);
        for (int k = 0; k < used; ++k) {
          const auto v = std::size_t(vertex[std::size_t(k)]);
          if (((masks[v] >> unsigned(bit[std::size_t(k)])) & 1U) == 0) continue;
          std::int32_t* cell = sums + v * lanes;
          std::int32_t outside = 0;
          for (std::size_t i = 0; i < lanes; ++i) {
            cell[i] += step.values[i];
            outside |= cell[i] + spill_limit;  // negative once |cell[i]| passes the limit
          }
          if (outside < 0) spill((slot * target_.cell_masks.size() + v) * lanes, lanes);
        }
      }
    }
  }
}

void PhotonDepositor::deposit_track_exact(const std::vector<PhotonSegment>& segments) {
  const V3i size = target_.frame.size;
  const auto lanes = std::size_t(target_.layout.lanes());
  for (const PhotonSegment& segment : segments) {
    const std::optional<IndexSegment> inside = clip(target_.frame, segment);
    if (!inside) continue;
    const std::size_t slot =
        target_.layout.slots == 8 ? octant_of(target_.frame.direction_to_local(-segment.direction)) : 0;
    const V3f& d = inside->per_metre;
    // Walks the quarter cells, as visibility is known for those.
    V3i quarter;
    V3f next_m;
    V3f stride_m;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const float x = inside->start[axis] * 4;
      quarter[axis] = std::clamp(static_cast<int>(x), 0, 4 * size[axis] - 1);
      const float speed = d[axis] * 4;
      constexpr float never = std::numeric_limits<float>::infinity();
      stride_m[axis] = speed == 0 ? never : 1 / std::abs(speed);
      const float border = static_cast<float>(quarter[axis] + (speed > 0 ? 1 : 0));
      next_m[axis] = speed == 0 ? never : (border - x) / speed;
    }
    float t = 0;
    while (t < inside->length_m) {
      const unsigned axis = next_m.x <= next_m.y ? (next_m.x <= next_m.z ? 0U : 2U) : (next_m.y <= next_m.z ? 1U : 2U);
      const float end = std::min(next_m[axis], inside->length_m);
      const std::size_t vertex = target_.frame.vertex_index(quarter.x >> 2, quarter.y >> 2, quarter.z >> 2);
      const int bit = ((quarter.z & 3) << 4) | ((quarter.y & 3) << 2) | (quarter.x & 3);
      if (end > t && ((target_.cell_masks[vertex] >> unsigned(bit)) & 1U) != 0) {
        const Lanes values = lanes_of(target_, segment, double(end) - t);
        for (std::size_t i = 0; i < lanes; ++i)
          atomic_add(target_.sums[(slot * target_.cell_masks.size() + vertex) * lanes + i], rounded(values[i]));
      }
      t = std::max(t, end);
      next_m[axis] += stride_m[axis];
      quarter[axis] += d[axis] > 0 ? 1 : -1;
      if (quarter[axis] < 0 || quarter[axis] >= 4 * size[axis]) break;
    }
  }
}

void PhotonDepositor::deposit_face(const std::vector<PhotonSegment>& segments) {
  const V3i size = target_.frame.size;
  const auto lanes = std::size_t(target_.layout.lanes());
  for (const PhotonSegment& segment : segments) {
    const std::optional<IndexSegment> inside = clip(target_.frame, segment);
    if (!inside) continue;
    const V3f w = target_.frame.direction_to_local(-segment.direction);
    for (unsigned axis = 0; axis < 3; ++axis) {
      const float speed = inside->per_metre[axis];
      if (speed == 0) continue;
      const double cosine = std::abs(double(w[axis]));
      const Lanes values = lanes_of(target_, segment, target_.estimator == Estimator::face ? 1 / cosine : 1.0);
      const std::size_t slot = 2 * axis + (w[axis] > 0 ? 0 : 1);
      // Faces lie at whole index coordinates, which are halves in the shifted ones.
      const float from = inside->start[axis] - 0.5F;
      const float to = from + speed * inside->length_m;
      const int first = static_cast<int>(std::ceil(std::min(from, to)));
      const int last = std::min(static_cast<int>(std::floor(std::max(from, to))), size[axis] - 1);
      for (int plane = std::max(first, 0); plane <= last; ++plane) {
        const V3f at = inside->start + inside->per_metre * ((static_cast<float>(plane) - from) / speed);
        V3i vertex;
        for (unsigned a = 0; a < 3; ++a) vertex[a] = std::clamp(static_cast<int>(at[a]), 0, size[a] - 1);
        vertex[axis] = plane;
        const std::size_t v = target_.frame.vertex_index(vertex.x, vertex.y, vertex.z);
        for (std::size_t i = 0; i < lanes; ++i)
          atomic_add(target_.sums[(slot * target_.cell_masks.size() + v) * lanes + i], rounded(values[i]));
      }
    }
  }
}

void PhotonDepositor::spill(std::size_t first_lane, int lanes) {
  for (std::size_t i = first_lane; i < first_lane + std::size_t(lanes); ++i) {
    atomic_add(target_.sums[i], sums_[i]);
    sums_[i] = 0;
  }
}

void PhotonDepositor::flush() {
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    if (sums_[i] != 0) atomic_add(target_.sums[i], sums_[i]);
  }
  std::fill(sums_.begin(), sums_.end(), 0);
}

}  // namespace ivory
