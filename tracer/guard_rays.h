// E(p, n) from a grid with leaks kept out: by rays to its vertices where the scene is at hand, by
// the compact guard stored in the file otherwise.
#pragma once

#include "grid/irradiance_grid.h"
#include "tracer/intersector.h"

namespace ivory {

// The footprint that a look-up at surface point p (geometric normal ng on the lit side) reads:
// p is nudged off the surface along ng by params.nudge_voxels, no farther than halfway to whatever
// stands in front of it, and vertices that do not see it are left out. Where those hold little of the
// weight, in narrow places, the vertices of the tricubic footprint that see p help out; where none does,
// the one that misses p least answers. `intersector` may be null unless guard is rays.
Footprint lookup_footprint(const IrradianceGrid& grid, const Intersector* intersector, Guard guard, const V3f& p,
                           const V3f& ng, const LookupParams& params);

// E(n) in lux per channel at p through that footprint; n is the shading normal.
Rgb lookup_irradiance(const IrradianceGrid& grid, const Intersector* intersector, Guard guard, const V3f& p,
                      const V3f& ng, const V3f& n, const LookupParams& params);

}  // namespace ivory
