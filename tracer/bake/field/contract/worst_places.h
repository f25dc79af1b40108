// Where a grid is worst, and why.
#pragma once

#include <vector>

#include "tracer/bake/field/contract/certificate.h"

namespace ivory {

// Up to eight of the points, the worst first, each off by more than the truth's noise explains; of points within two
// voxels or a twentieth of the grid of one another only the worst.
std::vector<WorstPlace> worst_places(const LitScene& lit, const std::vector<MeasuredPoint>& points,
                                     const IrradianceGrid& grid, double mean_e_lux);

}  // namespace ivory
