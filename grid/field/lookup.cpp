#include "grid/field/lookup.h"

#include <algorithm>
#include <cassert>

namespace ivory {

float nudge_m(const GridFrame& frame, const LookupParams& params) {
  const V3f& spacing = frame.spacing_m;
  return params.nudge_voxels * std::min({spacing.x, spacing.y, spacing.z});
}

namespace {

// One voxel farther off than `nudged`, by the planes: as far as the vertices near p see that point.
FarReading read_farther(const IrradianceGrid& grid, const V3f& nudged, const V3f& ng, float off_m, Guard guard,
                        const Footprint& near) {
  const V3f& spacing = grid.frame.spacing_m;
  const float voxel_m = std::min({spacing.x, spacing.y, spacing.z});
  const V3f p = nudged + ng * voxel_m;
  FarReading out{make_footprint(grid.frame, p, Interpolation::trilinear), 1};
  VisibleEntries visible;
  if (guard == Guard::planes && !grid.guard.empty()) {
    visible = visible_by_guard(grid, p, ng, off_m + voxel_m, out.footprint);
    const V3f index = grid.frame.to_index(p);
    out.share = 0;
    for (std::size_t i = 0; i < std::size_t(near.count); ++i) {
      const std::uint32_t vertex = near.vertex[i];
      if (near.weight[i] > 0 && hidden_by(grid.guard[vertex], index - V3f(grid.frame.vertex_coordinates(vertex))) <= 0)
        out.share += near.weight[i];
    }
  } else {
    visible.set();
  }
  const float kept = restrict_footprint(grid, visible, out.footprint);
  out.share = std::min(1.0F, out.share) * std::min(1.0F, kept / enough_weight);
  return out;
}

}  // namespace

Footprint lookup_footprint(const IrradianceGrid& grid, const V3f& p, const V3f& ng, const LookupParams& params) {
  assert(params.guard != Guard::rays);
  const float off_m = nudge_m(grid.frame, params);
  const V3f nudged = p + ng * off_m;
  const auto visible = [&](const Footprint& footprint, const Footprint* near) {
    if (params.guard == Guard::off) return VisibleEntries().set();
    return visible_by_guard(grid, nudged, ng, off_m, footprint, near);
  };
  if (params.interpolation == Interpolation::fitted) {
    return fitted_footprint(grid, p, nudged, visible, [&](const Footprint& near) {
      return read_farther(grid, nudged, ng, off_m, params.guard, near);
    });
  }
  if (params.guard == Guard::planes) {
    if (params.interpolation == Interpolation::trilinear)
      return guarded_footprint(grid, nudged, Interpolation::trilinear, visible);
    Footprint witnesses = make_footprint(grid.frame, nudged, Interpolation::trilinear);
    const bool any = restrict_footprint(grid, visible(witnesses, nullptr), witnesses) > 0;
    return guarded_footprint(grid, nudged, params.interpolation, [&](const Footprint& footprint, const Footprint*) {
      return visible(footprint, any ? &witnesses : nullptr);
    });
  }
  Footprint footprint = make_footprint(grid.frame, nudged, params.interpolation);
  restrict_footprint(grid, VisibleEntries().set(), footprint);
  return footprint;
}

Rgb lookup_irradiance(const IrradianceGrid& grid, const V3f& p, const V3f& ng, const V3f& n,
                      const LookupParams& params) {
  return irradiance(grid, lookup_footprint(grid, p, ng, params), n, params.reconstruction);
}

}  // namespace ivory
