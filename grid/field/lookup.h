// E(p, n) from a grid with leaks kept out by what the file itself stores. Needs no scene; its twin for the GPU is
// shaders/field/irradiance_grid.glsl. With rays in place of the planes: tracer/render/guard_rays.h.
#pragma once

#include "grid/field/guard.h"
#include "grid/field/irradiance_grid.h"
#include "grid/field/linear_fit.h"

namespace ivory {

// How far a look-up in that level moves off the surface, in metres: by the smallest spacing.
float nudge_m(const GridFrame& frame, const LookupParams& params);

// The footprint read at a point. visible(footprint, near) says as VisibleEntries which entries see it, each from as far
// off the surface as its level reads it; the others are left out (`near`: as visible_by_guard() has it). Where what is
// left holds less than `enough_weight`, in narrow places, the vertices of the tricubic footprint that see the point
// help out. Where none does, no entry is left, which reads as dark: on the outside of a lit house, and in gaps that no
// vertex sees into. (Such gaps of a cluttered room, 8 to 32 vertices long, had 0.15 to 0.18 of its mean light. The
// vertex least hidden by its planes answered 0.34 to 0.88.)
inline constexpr float enough_weight = 0.25F;
template <typename Visible>
Footprint guarded_footprint(const IrradianceGrid& grid, const LookupPoint& at, Interpolation interpolation,
                            const Visible& visible) {
  Footprint footprint = make_footprint(grid, at, interpolation);
  const float kept = restrict_footprint(grid, visible(footprint, nullptr), footprint);
  if (kept >= enough_weight) return footprint;

  if (interpolation == Interpolation::trilinear) {
    Footprint wide = make_footprint(grid, at, Interpolation::tricubic);
    if (restrict_footprint(grid, visible(wide, kept > 0 ? &footprint : nullptr), wide) > 0) {
      footprint = blend(footprint, wide, kept / enough_weight);
      return footprint;
    }
  }
  if (kept == 0) footprint.count = 0;
  return footprint;
}

// The footprint of Interpolation::fitted at at.p: the vertices read as above and those of a second, trilinear footprint
// one voxel farther off. far(near) answers that one, restricted, and how much it counts, 0 to 1. It has 0.3
// of the weight before the fit.
inline constexpr float far_weight = 0.3F;
struct FarReading {
  Footprint footprint;
  float share = 0;
};
template <typename Visible, typename Far>
Footprint fitted_footprint(const IrradianceGrid& grid, const LookupPoint& at, const Visible& visible, const Far& far) {
  const Footprint near = guarded_footprint(grid, at, Interpolation::trilinear, visible);
  if (near.count == 0) return near;
  const FarReading reading = far(near);
  return fit_linear(grid, at.p, blend(near, reading.footprint, 1 - far_weight * reading.share));
}

// The footprint that a look-up at surface point p (world, m; unit geometric normal ng on the lit side) reads, by the
// stored planes or without guard: p is nudged off the surface along ng by params.nudge_voxels. params.guard is planes
// or off. Without entries where no vertex sees p.
Footprint lookup_footprint(const IrradianceGrid& grid, const V3f& p, const V3f& ng, const LookupParams& params);

// E(n) in lux per channel at p through that footprint; n is the unit shading normal. Throws as irradiance() does.
Rgb lookup_irradiance(const IrradianceGrid& grid, const V3f& p, const V3f& ng, const V3f& n,
                      const LookupParams& params);

}  // namespace ivory
