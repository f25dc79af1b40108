#include "grid/export/survey/plane_points.h"

#include <algorithm>
#include <cmath>

#include "grid/base/counted_random.h"
#include "grid/field/guard.h"
#include "grid/field/yield.h"

namespace ivory {

std::optional<SurfacePoint> plane_point(const IrradianceGrid& grid, std::uint64_t seed, std::uint64_t index) {
  constexpr std::uint64_t numbers_a_try = 8;
  const auto uniform = [&](std::uint64_t k) { return counted_uniform(seed, numbers_a_try * index + k); };
  const auto vertex = std::uint32_t(uniform(0) * double(grid.vertex_count()));
  if (!is_lit(grid, vertex)) return std::nullopt;
  const auto plane = unpack(grid.guard[vertex].words[std::size_t(uniform(1) * guard_planes)]);
  if (!plane || plane->distance < 0 || plane->distance > 1) return std::nullopt;
  V3f u(float(2 * uniform(2) - 1), float(2 * uniform(3) - 1), float(2 * uniform(4) - 1));
  u += plane->normal * (plane->distance - plane->normal.dot(u));
  constexpr float rounding = 1e-3F;  // it lies in that plane, and before the others
  if (std::max({std::abs(u.x), std::abs(u.y), std::abs(u.z)}) > 1 || hidden_by(grid.guard[vertex], u) > rounding)
    return std::nullopt;
  const VertexPlace place = grid.place_of(vertex);
  const GridFrame& frame = grid.frame_of(place.level);
  const V3f p = frame.to_world(V3f(place.at) + u);
  if (!grid.frame.covers(p)) return std::nullopt;
  // A plane of index coordinates q: its normal in metres goes with 1 / spacing.
  return SurfacePoint{p, frame.direction_to_world(-plane->normal / frame.spacing_m).normalized()};
}

}  // namespace ivory
