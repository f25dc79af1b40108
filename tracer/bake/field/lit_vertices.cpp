#include "tracer/bake/field/lit_vertices.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "tracer/bake/field/deposit/target.h"

namespace ivory {

std::vector<bool> lit_vertices(const PhotonTracer& tracer, const Lattice& lattice,
                               const std::vector<std::uint64_t>& cell_masks, std::uint64_t photons) {
  std::vector<std::atomic<bool>> lit(lattice.vertex_count());
  const auto mark_at = [&](std::size_t vertex, unsigned bit) {
    if (((cell_masks[vertex] >> bit) & 1U) != 0) lit[vertex].store(true, std::memory_order_relaxed);
  };
  const auto mark = [&](const PhotonSegment& segment) {
    const std::optional<IndexSegment> inside = clip(lattice.frame, segment);
    if (!inside) return;
    const V3f& d = inside->per_metre;
    const float step_m = 1 / std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    for (float t = segment.jitter * step_m; t < inside->length_m; t += step_m) {
      const V3f p = (inside->start + d * t) * 4.0F;
      V3i cell;
      unsigned bit = 0;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const int quarter = std::clamp(static_cast<int>(p[axis]), 0, 4 * lattice.frame.size[axis] - 1);
        cell[axis] = quarter >> 2;
        bit |= static_cast<unsigned>(quarter & 3) << (2 * axis);
      }
      mark_at(lattice.frame.vertex_index(cell.x, cell.y, cell.z), bit);
    }
    for (const BrickLevel& level : lattice.finer) {
      if (const auto run = sample_run(level.frame, segment)) for_each_sample(level, *run, mark_at, [] {});
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, photons, 1024), [&](const auto& range) {
    std::vector<PhotonSegment> segments;
    PhotonLedger ledger;
    tracer.trace(range.begin(), range.end(), segments, ledger);
    for (const PhotonSegment& segment : segments) mark(segment);
  });
  return {lit.begin(), lit.end()};
}

}  // namespace ivory
