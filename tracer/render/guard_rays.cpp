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

LookupPoint point_by_rays(const IrradianceGrid& grid, const Intersector& intersector, const V3f& p, const V3f& ng,
                          const LookupParams& params) {
  LookupParams reach = params;
  if (params.interpolation == Interpolation::fitted) reach.nudge_voxels += 1;
  const float t_max = 2 * nudge_m(grid.frame, reach);  // of the coarsest level
  V3f origin = offset_origin(p, ng, ng);
  auto ahead =
      intersector.closest({.origin = origin, .direction = ng, .t_max = t_max, .blocking_coverage = half_coverage});
  if (ahead && is_own_surface(intersector.scene(), *ahead, ahead->t, ng)) {
    origin = offset_origin(p, ng, ng, triangle_reach_m(intersector.scene(), ahead->instance, ahead->triangle));
    ahead =
        intersector.closest({.origin = origin, .direction = ng, .t_max = t_max, .blocking_coverage = half_coverage});
  }
  return {.p = origin,
          .ng = ng,
          .nudge_voxels = params.nudge_voxels,
          .most_m = ahead ? ahead->t / 2 : std::numeric_limits<float>::infinity()};
}

Footprint lookup_footprint(const IrradianceGrid& grid, const Intersector* intersector, const V3f& p, const V3f& ng,
                           const LookupParams& params) {
  if (params.guard != Guard::rays) return lookup_footprint(grid, p, ng, params);
  assert(intersector != nullptr);
  const bool fitted = params.interpolation == Interpolation::fitted;
  const LookupPoint at = point_by_rays(grid, *intersector, p, ng, params);
  const auto visible = [&](const Footprint& footprint, const Footprint* /*near*/) {
    return visible_by_rays(grid, *intersector, at, footprint);
  };
  if (!fitted) return guarded_footprint(grid, at, params.interpolation, visible);
  // The second reading fades where something stands in front, and counts nothing half a voxel before the first.
  const auto read_near = [&](int level) {
    return guarded_level_footprint(grid, level, at, Interpolation::trilinear, visible);
  };
  return fitted_footprint(grid, at, read_near, [&](int level, const Footprint& /*near*/) {
    LookupPoint farther = at;
    farther.nudge_voxels += 1;
    FarReading out{make_footprint(grid, level, farther, Interpolation::trilinear), 0};
    const GridFrame& frame = grid.frame_of(level);
    const V3f& h = frame.spacing_m;
    const float apart = (farther.off_m(frame) - at.off_m(frame)) / std::min({h.x, h.y, h.z});
    if (apart <= 0.5F) return out;
    const float kept =
        restrict_footprint(grid, visible_by_rays(grid, *intersector, farther, out.footprint), out.footprint);
    out.share = std::min(1.0F, 2 * apart - 1) * std::min(1.0F, kept / enough_weight);
    return out;
  });
}

Footprint lookup_footprint_in_doubt_by_rays(const IrradianceGrid& grid, const Intersector& intersector, const V3f& p,
                                            const V3f& ng, LookupParams params) {
  if (!grid.guard.empty()) {
    params.guard = Guard::planes;
    const Footprint footprint = lookup_footprint(grid, p, ng, params);
    // A tricubic footprint is wide without having been asked for help.
    const bool helped = footprint.wide && params.interpolation != Interpolation::tricubic;
    if (footprint.count > 0 && !helped) return footprint;
  }
  params.guard = Guard::rays;
  return lookup_footprint(grid, &intersector, p, ng, params);
}

Rgb lookup_irradiance(const IrradianceGrid& grid, const Intersector* intersector, const V3f& p, const V3f& ng,
                      const V3f& n, const LookupParams& params) {
  return irradiance(grid, lookup_footprint(grid, intersector, p, ng, params), n, params.reconstruction);
}

}  // namespace ivory
