// FIV tables of a mesh that turns under its environment (grid/fiv/set.h).
#pragma once

#include "grid/fiv/set.h"
#include "tracer/bake/fiv/baker.h"

namespace ivory {

// The occluder turned about +Y by turn_rad, counter-clockwise seen from above, about its bounding sphere's centre. Its
// shape stays that of the mesh unturned.
FivOccluder turned(const FivOccluder& occluder, double turn_rad);

// A table for each of `turns` (1 to 360) evenly spaced turns, all on the spheres of the first. Throws as bake_fiv()
// does.
FivSet bake_fiv_turns(const FivOccluder& occluder, const CubeMap& environment, const FivParams& params, int turns);

}  // namespace ivory
