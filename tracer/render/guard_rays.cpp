#include "tracer/render/guard_rays.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

#include "grid/field/lookup.h"
#include "tracer/core/surface.h"

namespace ivory {
namespace {

VisibleEntries visible_by_rays(const IrradianceGrid& grid, const Intersector& intersector, const LookupPoint& at,
                               const Footprint& footprint) {
  VisibleEntries visible;
  if (footprint.count == 0) return visible;
  const GridFrame& frame = grid.frame_of(grid.level_of(footprint.vertex[0]));  // as that of all
  const V3f p = at.nudged(frame);
  std::array<V3f, 8> targets;
  std::array<std::size_t, 8> entries{};
  int filled = 0;
  const auto query = [&] {
    const std::uint32_t bits = intersector.visible(p, targets, filled);
    for (int i = 0; i < filled; ++i) {
      if (((bits >> unsigned(i)) & 1U) != 0) visible.set(entries[std::size_t(i)]);
    }
    filled = 0;
  };
  for (std::size_t i = 0; i < std::size_t(footprint.count); ++i) {
    const std::uint32_t vertex = footprint.vertex[i];
    if (footprint.weight[i] == 0 || grid.visible_fraction[vertex] <= 0) continue;
    targets[std::size_t(filled)] = frame.to_world(V3f(grid.place_of(vertex).at));
    entries[std::size_t(filled++)] = i;
    if (filled == 8) query();
  }
  if (filled > 0) query();
  return visible;
}

}  // namespace

Footprint lookup_footprint(const IrradianceGrid& grid, const Intersector* intersector, const V3f& p, const V3f& ng,
                           const LookupParams& params) {
  if (params.guard != Guard::rays) return lookup_footprint(grid, p, ng, params);
  assert(intersector != nullptr);
  const float most_m = nudge_m(grid.frame, params);  // of the coarsest level
  V3f origin = offset_origin(p, ng, ng);
  auto ahead = intersector->closest(
      {.origin = origin, .direction = ng, .t_max = 2 * most_m, .blocking_coverage = half_coverage});
  if (ahead && is_own_surface(intersector->scene(), *ahead, ahead->t, ng)) {
    origin = offset_origin(p, ng, ng, triangle_reach_m(intersector->scene(), ahead->instance, ahead->triangle));
    ahead = intersector->closest(
        {.origin = origin, .direction = ng, .t_max = 2 * most_m, .blocking_coverage = half_coverage});
  }
  const LookupPoint at{.p = origin,
                       .ng = ng,
                       .nudge_voxels = params.nudge_voxels,
                       .most_m = ahead ? ahead->t / 2 : std::numeric_limits<float>::infinity()};
  return guarded_footprint(grid, at, params.interpolation, [&](const Footprint& footprint, const Footprint* /*near*/) {
    return visible_by_rays(grid, *intersector, at, footprint);
  });
}

Rgb lookup_irradiance(const IrradianceGrid& grid, const Intersector* intersector, const V3f& p, const V3f& ng,
                      const V3f& n, const LookupParams& params) {
  return irradiance(grid, lookup_footprint(grid, intersector, p, ng, params), n, params.reconstruction);
}

}  // namespace ivory
