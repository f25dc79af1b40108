// Fronts outward for meshes whose triangles run this way and that.
#pragma once

#include "tracer/bake/spheres/winding_number.h"

namespace ivory {

// Turns triangles so that what rays find inside lies behind them. Inside is where an odd number of surfaces lies ahead
// along at least two of the three axes, which needs no orientation but closed surfaces; triangles with the same
// on both sides keep theirs. The mesh lies in [0, size], the longest side 1; `resolution` rays along that.
void orient_by_parity(std::vector<Triangle3d>& triangles, const V3d& size, int resolution);

}  // namespace ivory
