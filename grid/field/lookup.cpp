#include "grid/field/lookup.h"

#include <algorithm>
#include <cassert>

namespace ivory {

float nudge_m(const GridFrame& frame, const LookupParams& params) {
  const V3f& spacing = frame.spacing_m;
  return params.nudge_voxels * std::min({spacing.x, spacing.y, spacing.z});
}

namespace {

// One voxel farther off, by the planes: as far as the vertices near the surface see that point.
FarReading read_farther(const IrradianceGrid& grid, const LookupPoint& at, Guard guard, const Footprint& near) {
  LookupPoint farther = at;
  farther.nudge_voxels += 1;
  FarReading out{make_footprint(grid, farther, Interpolation::trilinear), 1};
  VisibleEntries visible;
  if (guard == Guard::planes && !grid.guard.empty()) {
    visible = visible_by_guard(grid, farther, out.footprint);
    out.share = 0;
    for (std::size_t i = 0; i < std::size_t(near.count); ++i) {
      if (!(near.weight[i] > 0)) continue;
      const VertexPlace place = grid.place_of(near.vertex[i]);
      const GridFrame& frame = grid.frame_of(place.level);
      const V3f offset = frame.to_index(farther.nudged(frame)) - V3f(place.at);
      if (hidden_by(grid.guard[near.vertex[i]], offset) <= 0) out.share += near.weight[i];
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
  const LookupPoint at{.p = p, .ng = ng, .nudge_voxels = params.nudge_voxels};
  const auto visible = [&](const Footprint& footprint, const Footprint* near) {
    return params.guard == Guard::off ? VisibleEntries().set() : visible_by_guard(grid, at, footprint, near);
  };
  if (params.interpolation == Interpolation::fitted) {
    return fitted_footprint(grid, at, visible,
                            [&](const Footprint& near) { return read_farther(grid, at, params.guard, near); });
  }
  if (params.guard == Guard::planes) {
    if (params.interpolation == Interpolation::trilinear)
      return guarded_footprint(grid, at, Interpolation::trilinear, visible);
    Footprint witnesses = make_footprint(grid, at, Interpolation::trilinear);
    const bool any = restrict_footprint(grid, visible(witnesses, nullptr), witnesses) > 0;
    return guarded_footprint(grid, at, params.interpolation, [&](const Footprint& footprint, const Footprint*) {
      return visible(footprint, any ? &witnesses : nullptr);
    });
  }
  Footprint footprint = make_footprint(grid, at, params.interpolation);
  restrict_footprint(grid, VisibleEntries().set(), footprint);
  return footprint;
}

Rgb lookup_irradiance(const IrradianceGrid& grid, const V3f& p, const V3f& ng, const V3f& n,
                      const LookupParams& params) {
  return irradiance(grid, lookup_footprint(grid, p, ng, params), n, params.reconstruction);
}

}  // namespace ivory
