#include "tracer/render/guard_rays.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "grid/field/lookup.h"
#include "tracer/core/surface.h"

namespace ivory {
namespace {

VisibleEntries visible_by_rays(const IrradianceGrid& grid, const Intersector& intersector, const V3f& p,
                               const Footprint& footprint) {
  VisibleEntries visible;
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
    targets[std::size_t(filled)] = grid.frame.to_world(V3f(grid.frame.vertex_coordinates(vertex)));
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
  const V3f& spacing = grid.frame.spacing_m;
  const bool fitted = params.interpolation == Interpolation::fitted;
  const float voxel_m = std::min({spacing.x, spacing.y, spacing.z});
  const float near_m = nudge_m(grid.frame, params);
  const float far_m = near_m + voxel_m;
  const float reach_m = 2 * (fitted ? far_m : near_m);
  V3f origin = offset_origin(p, ng, ng);
  auto ahead =
      intersector->closest({.origin = origin, .direction = ng, .t_max = reach_m, .blocking_coverage = half_coverage});
  if (ahead && is_own_surface(intersector->scene(), *ahead, ahead->t, ng)) {
    origin = offset_origin(p, ng, ng, triangle_reach_m(intersector->scene(), ahead->instance, ahead->triangle));
    ahead =
        intersector->closest({.origin = origin, .direction = ng, .t_max = reach_m, .blocking_coverage = half_coverage});
  }
  const float halfway_m = ahead ? ahead->t / 2 : reach_m;
  const V3f nudged = origin + ng * std::min(near_m, halfway_m);
  const auto visible = [&](const Footprint& footprint, const Footprint* /*near*/) {
    return visible_by_rays(grid, *intersector, nudged, footprint);
  };
  if (!fitted) return guarded_footprint(grid, nudged, params.interpolation, visible);
  // The second reading fades where something stands in front, and counts nothing half a voxel before the first.
  return fitted_footprint(grid, p, nudged, visible, [&](const Footprint& /*near*/) {
    const V3f farther = origin + ng * std::min(far_m, halfway_m);
    FarReading out{make_footprint(grid.frame, farther, Interpolation::trilinear), 0};
    const float apart = std::max(0.0F, std::min(far_m, halfway_m) - near_m) / voxel_m;
    if (apart <= 0.5F) return out;
    const float kept =
        restrict_footprint(grid, visible_by_rays(grid, *intersector, farther, out.footprint), out.footprint);
    out.share = (2 * apart - 1) * std::min(1.0F, kept / enough_weight);
    return out;
  });
}

Rgb lookup_irradiance(const IrradianceGrid& grid, const Intersector* intersector, const V3f& p, const V3f& ng,
                      const V3f& n, const LookupParams& params) {
  return irradiance(grid, lookup_footprint(grid, intersector, p, ng, params), n, params.reconstruction);
}

}  // namespace ivory
