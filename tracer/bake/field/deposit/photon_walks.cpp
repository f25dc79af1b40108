// The walks that bakes do not take: cell by cell, and face by face.
//
// The face estimators of RR-6983 section 3.3 add power w (face_paper) or power w / |cos| (face) where
// a segment crosses a voxel face, to the nearest of the face's vertices, and divide by the face's area.
// Here every vertex stands in the middle of a whole cell, so the paper's half and quarter areas at the
// grid's border do not arise.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tracer/bake/field/deposit/photon_deposit.h"
#include "tracer/bake/field/deposit/units.h"

namespace ivory {
namespace {

// Subcell bit within a cell, from a position in quarters of a voxel.
unsigned subcell(int x, int y, int z) { return static_cast<unsigned>(((z & 3) << 4) | ((y & 3) << 2) | (x & 3)); }

}  // namespace

// Whole cells are stepped through exactly; a cell that its vertex does not see whole is stepped
// through by its quarters, and only the visible ones count.
template <int lanes>
void PhotonDepositor::walk_cells(const PhotonSegment& segment, int level) {
  const GridFrame& frame = target_.lattice.frame_of(level);
  const std::optional<IndexSegment> inside = clip(frame, segment);
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

  walk(1, 0, inside->length_m, V3i(0, 0, 0), frame.size - V3i(1, 1, 1), [&](const V3i& cell, float from_m, float to_m) {
    const std::size_t vertex = level == 0 ? frame.vertex_index(cell.x, cell.y, cell.z)
                                          : target_.lattice.finer[std::size_t(level - 1)].vertex_at(cell);
    if (level != 0 && vertex >= no_brick) return;
    const std::uint64_t mask = target_.cell_masks[vertex];
    float length_m = to_m - from_m;
    if (~mask != 0) {
      length_m = 0;
      walk(4, from_m, to_m, cell * 4, cell * 4 + V3i(3, 3, 3), [&](const V3i& quarter, float from, float to) {
        if (((mask >> subcell(quarter.x, quarter.y, quarter.z)) & 1U) != 0) length_m += to - from;
      });
    }
    if (length_m <= 0) return;
    length_m = std::ldexp(length_m, level);  // in the level's unit
    std::array<float, lanes> values;
    for (std::size_t i = 0; i < lanes; ++i)
      values[i] = a_metre.values[i] * (i + 3 < lanes ? length_m : length_m * length_m);
    add_step<lanes>(a_metre.slot, vertex, values.data(), segment);
  });
}

void PhotonDepositor::cross_faces(const PhotonSegment& segment) {
  const GridFrame& frame = target_.lattice.frame;
  const V3i size = frame.size;
  const std::optional<IndexSegment> inside = clip(frame, segment);
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
      add_step<12>(a_crossing.slot, frame.vertex_index(vertex.x, vertex.y, vertex.z), a_crossing.values.data(),
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
    // By slot and vertex, wherever their lanes lie.
    const auto step = static_cast<std::uint32_t>((slot * target_.cell_masks.size() + vertex) * lanes);
    const std::uint32_t key = mixed(rounding_key(segment) ^ step);
    for (std::size_t i = 0; i < lanes; ++i) integers[i] = rounded_at_random(values[i], target_.fine_bits, key, i);
  } else {
    for (std::size_t i = 0; i < lanes; ++i) integers[i] = rounded(values[i]);
  }
  if (target_.buffers == DepositBuffers::shared) {
    add_shared<lanes>(target_.sums.data() + first, integers.data(), scale.unit_bits);
  } else {
    std::int32_t* const own = cell(scale, slot, vertex);
    for (std::size_t i = 0; i < lanes; ++i) own[i] += integers[i];
    if (is_past_limit(own, lanes)) spill(scale, slot, vertex);
  }
}

template void PhotonDepositor::walk_cells<12>(const PhotonSegment&, int);
template void PhotonDepositor::walk_cells<15>(const PhotonSegment&, int);
template void PhotonDepositor::walk_cells<30>(const PhotonSegment&, int);

}  // namespace ivory
