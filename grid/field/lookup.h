// E(p, n) from a grid with leaks kept out by what the file itself stores. Needs no scene; its twin for the GPU is
// shaders/field/irradiance_grid.glsl. With rays in place of the planes: tracer/render/guard_rays.h.
#pragma once

#include "grid/field/guard.h"
#include "grid/field/irradiance_grid.h"
#include "grid/field/linear_fit.h"

namespace ivory {

// How far a look-up in that level moves off the surface, in metres: by the smallest spacing.
float nudge_m(const GridFrame& frame, const LookupParams& params);

// Where a footprint keeps less weight than this, others help out.
inline constexpr float enough_weight = 0.25F;

// The footprint read at a point in one level. visible(footprint, near) says as VisibleEntries which entries see it,
// from as far off the surface as the level reads it; the others are left out (`near`: as visible_by_guard() has it).
// Where what is left holds less than `enough_weight`, in narrow places, the vertices of the tricubic footprint that see
// the point help out. Where none does, no entry is left, which reads as dark: on the outside of a lit house, and in
// gaps that no vertex sees into. (Such gaps of a cluttered room, 8 to 32 vertices long, had 0.15 to 0.18 of its mean
// light. The vertex least hidden by its planes answered 0.34 to 0.88.)
//
// helped_footprint() does so for `near`, the trilinear one, of which `kept` is left.
template <typename Visible>
Footprint helped_footprint(const IrradianceGrid& grid, int level, const LookupPoint& at, const Footprint& near,
                           float kept, const Visible& visible) {
  if (kept >= enough_weight) return near;
  Footprint wide = make_footprint(grid, level, at, Interpolation::tricubic);
  if (restrict_footprint(grid, visible(wide, kept > 0 ? &near : nullptr), wide) > 0)
    return blend(near, wide, kept / enough_weight);
  return kept > 0 ? near : Footprint{};
}
template <typename Visible>
Footprint guarded_level_footprint(const IrradianceGrid& grid, int level, const LookupPoint& at,
                                  Interpolation interpolation, const Visible& visible) {
  Footprint footprint = make_footprint(grid, level, at, interpolation);
  const float kept = restrict_footprint(grid, visible(footprint, nullptr), footprint);
  if (interpolation == Interpolation::trilinear) return helped_footprint(grid, level, at, footprint, kept, visible);
  if (kept == 0) footprint.count = 0;
  return footprint;
}

// The footprints of all levels, read_level(level), by their shares. Of two that meet one may have no entry: the other
// answers alone.
template <typename ReadLevel>
Footprint footprint_of_levels(const IrradianceGrid& grid, const LookupPoint& at, const ReadLevel& read_level) {
  const LevelShares shares = level_shares(grid, at);
  Footprint footprint = read_level(shares.level[0]);
  if (shares.share[1] <= 0) return footprint;
  const Footprint coarser = read_level(shares.level[1]);
  if (coarser.count > 0) footprint = footprint.count > 0 ? blend(footprint, coarser, shares.share[0]) : coarser;
  return footprint;
}

template <typename Visible>
Footprint guarded_footprint(const IrradianceGrid& grid, const LookupPoint& at, Interpolation interpolation,
                            const Visible& visible) {
  return footprint_of_levels(
      grid, at, [&](int level) { return guarded_level_footprint(grid, level, at, interpolation, visible); });
}

// The footprint of Interpolation::fitted at at.p: of each level the vertices that read_near(level) answers, as above,
// and those of a second, trilinear footprint one voxel farther off. far(level, near) answers that one, restricted, and
// how much it counts, 0 to 1. It has 0.3 of the weight before the fit.
inline constexpr float far_weight = 0.3F;
struct FarReading {
  Footprint footprint;
  float share = 0;
};
template <typename ReadNear, typename Far>
Footprint fitted_footprint(const IrradianceGrid& grid, const LookupPoint& at, const ReadNear& read_near,
                           const Far& far) {
  return footprint_of_levels(grid, at, [&](int level) {
    const Footprint near = read_near(level);
    if (near.count == 0) return near;
    const FarReading reading = far(level, near);
    return fit_linear(grid, level, at.p, blend(near, reading.footprint, 1 - far_weight * reading.share));
  });
}

// The eight vertices around the point that see it, by the stored planes. Where what they are cannot see p itself, a
// wall stands between, and the point is read closer to p: off it by closer_share of the nudge, if a vertex sees it
// there.
inline constexpr float closer_share = 0.1875F;
LookupPoint closer_point(const LookupPoint& at);
struct NearReading {
  LookupPoint at;       // as it was asked for, or closer
  Footprint footprint;  // restricted to the vertices that see it
  float kept = 0;       // their weight; 0: none does
};
NearReading read_near(const IrradianceGrid& grid, int level, const LookupPoint& at);

// The footprint that a look-up at surface point p (world, m; unit geometric normal ng on the lit side) reads, by the
// stored planes or without guard: p is nudged off the surface along ng by params.nudge_voxels (by planes less where a
// wall is nearer: read_near()). params.guard is planes or off. Without entries where no vertex sees p.
Footprint lookup_footprint(const IrradianceGrid& grid, const V3f& p, const V3f& ng, const LookupParams& params);

// E(n) in lux per channel at p through that footprint; n is the unit shading normal. Throws as irradiance() does.
Rgb lookup_irradiance(const IrradianceGrid& grid, const V3f& p, const V3f& ng, const V3f& n,
                      const LookupParams& params);

}  // namespace ivory
