#include "grid/field/lookup.h"

#include <algorithm>
#include <cassert>

namespace ivory {

float nudge_m(const GridFrame& frame, const LookupParams& params) {
  const V3f& spacing = frame.spacing_m;
  return params.nudge_voxels * std::min({spacing.x, spacing.y, spacing.z});
}

Footprint lookup_footprint(const IrradianceGrid& grid, const V3f& p, const V3f& ng, const LookupParams& params) {
  assert(params.guard != Guard::rays);
  const LookupPoint at{.p = p, .ng = ng, .nudge_voxels = params.nudge_voxels};
  if (params.guard == Guard::planes) {
    return guarded_footprint(grid, at, params.interpolation, [&](const Footprint& footprint, const Footprint* near) {
      return visible_by_guard(grid, at, footprint, near);
    });
  }
  return footprint_of_levels(grid, at, [&](int level) {
    Footprint footprint = make_footprint(grid, level, at, params.interpolation);
    const float kept = restrict_footprint(grid, VisibleEntries().set(), footprint);
    if (kept == 0 && grid.levels() > 1) footprint.count = 0;  // the other level may know better
    return footprint;
  });
}

Rgb lookup_irradiance(const IrradianceGrid& grid, const V3f& p, const V3f& ng, const V3f& n,
                      const LookupParams& params) {
  return irradiance(grid, lookup_footprint(grid, p, ng, params), n, params.reconstruction);
}

}  // namespace ivory
