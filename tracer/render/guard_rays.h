// E(p, n) from a grid with leaks kept out: by rays to its vertices where the scene is at hand, by
// the compact guard stored in the file otherwise (grid/field/lookup.h).
#pragma once

#include "grid/field/irradiance_grid.h"
#include "tracer/core/intersector.h"

namespace ivory {

// Where a look-up by rays at surface point p reads: off its own surface, and no farther than halfway to what is in
// front.
LookupPoint point_by_rays(const IrradianceGrid& grid, const Intersector& intersector, const V3f& p, const V3f& ng,
                          const LookupParams& params);

// As the functions of the same name in grid/field/lookup.h, for every guard. With rays, p is nudged no farther than
// halfway to whatever stands in front of it. `intersector` may be null unless params.guard is rays.
Footprint lookup_footprint(const IrradianceGrid& grid, const Intersector* intersector, const V3f& p, const V3f& ng,
                           const LookupParams& params);

// By the stored planes, and by rays where those leave a doubt: where no vertex sees the point by them, or those around
// it so little that farther ones help out. For what gather rays meet, where it is as exact as rays alone: what remains
// of the planes' errors is spread over all that sees the place. A grid without planes is read by rays.
Footprint lookup_footprint_in_doubt_by_rays(const IrradianceGrid& grid, const Intersector& intersector, const V3f& p,
                                            const V3f& ng, LookupParams params);

// E(n) in lux per channel at p through that footprint; n is the shading normal.
Rgb lookup_irradiance(const IrradianceGrid& grid, const Intersector* intersector, const V3f& p, const V3f& ng,
                      const V3f& n, const LookupParams& params);

}  // namespace ivory
