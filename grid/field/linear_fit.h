// Look-ups that are exact for fields linear in position: after the gradients of RR-6983, from the vertices themselves.
#pragma once

#include "grid/field/irradiance_grid.h"

namespace ivory {

// Where what a vertex stores was measured: the middle of the part of its cell that it sees by its guard planes, as an
// offset from it in voxels along the grid's axes, each within [-0.45, 0.45]. Exact for one plane along an axis.
V3f measured_at(const GuardRecord& record);

// How noisy a vertex is: the variance of E over the square of its light, 0 to 1; 0 where it holds none.
float relative_variance(const IrradianceGrid& grid, std::size_t vertex);

// The weights of a linear fit at p (world, m) to what the entries of `seen` measured, weighted by theirs, which add up
// to one. So do the new ones, some of which may be negative; none is larger than four times the old one for a p within
// a voxel of the entries' middle. A ridge pulls the fit's gradient to zero: little where light is well known, wholly
// where it is noise.
Footprint fit_linear(const IrradianceGrid& grid, const V3f& p, const Footprint& seen);

}  // namespace ivory
