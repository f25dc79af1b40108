// From exact integer sums to the moments that a grid stores.
#pragma once

#include "grid/field/accumulator.h"

namespace ivory {

// Divides by cell volume (track) or face area (face) and by the number of photons, and folds to the stored moments, in
// lux. Without photons, and at vertices that store nothing, all is zero.
// Groups of lights are left out.
IrradianceGrid resolve(const GridAccumulator& accumulator);

// With them.
IrradianceGrid resolve_groups(const GridAccumulator& accumulator);

}  // namespace ivory
