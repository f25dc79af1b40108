// Environments turned about +Y: a sky that goes round.
#pragma once

#include "grid/env/latlong_map.h"

namespace ivory {

// The same light turned by turn_deg counter-clockwise seen from above: what came from +Z comes from +X after a quarter
// of a turn. By whole columns the map's own texels; else each new texel is the mean of the two that it covers, by area,
// so that every row keeps its flux and edges blur by less than a texel.
EnvironmentMap turned(const EnvironmentMap& map, double turn_deg);

}  // namespace ivory
