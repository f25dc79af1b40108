// Which vertices give way to others among those that the planes of the guard let through.
//
// Four planes cannot tell all that a vertex sees. Beside inner edges they let surfaces see vertices in walls and
// outside of the house, which draws seams there. What others know tells them: that they are lit, and what their own
// planes hide.
#pragma once

#include "grid/field/irradiance_grid.h"

namespace ivory {

// Did any light come to the vertex? One that stores nothing is unlit too.
bool is_lit(const IrradianceGrid& grid, std::size_t vertex);

// What is left of `visible`, the entries of the eight vertices around a point that their planes let through. in_front
// are those whose vertices stand before the surface that the point lies on, none where it lies on none.
//   1. Unlit entries give way, where a lit one of least_weight or more is visible in front.
//   2. The heaviest of those that are left in front, if of more than least_weight, is the witness. Those that are not
//      in front give way where the witness does not see their vertices, by its planes.
// A footprint's vertices are of one level here and below.
VisibleEntries yield_near(const IrradianceGrid& grid, const Footprint& footprint, const VisibleEntries& visible,
                          const VisibleEntries& in_front);

// The same for a wide footprint, whose vertices' planes know of no wall that is more than a voxel away. Here all
// entries of `near`, of the eight vertices, that have least_weight are witnesses, and whatever one of them
// does not see gives way; the heaviest in front is, where `near` is null. Then the unlit entries do, as above.
VisibleEntries yield_wide(const IrradianceGrid& grid, const Footprint& footprint, const VisibleEntries& visible,
                          const VisibleEntries& in_front, const Footprint* near);

}  // namespace ivory
