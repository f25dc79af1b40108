// What directional bases make of the light at a grid's place, all else being exact.
#pragma once

#include <optional>
#include <vector>

#include "tracer/bake/field/contract/certificate.h"

namespace ivory {

// Root mean squares over the points ÷ mean E.
struct DirectionErrors {
  double vectors = 0;
  double vectors9 = 0;
  double sh9 = 0;
};

// At up to 128 of the points, a quarter of a voxel off their surfaces: radiance along directions of the whole sphere,
// path-traced, summed once to E and once to the moments of each basis in the frame's axes. Both come from the same
// paths, so that nearly all of their noise is shared. Indirect light.
DirectionErrors direction_errors(const LitScene& lit, const std::vector<MeasuredPoint>& points, const GridFrame& frame,
                                 double mean_e_lux, const TruthParams& params);

}  // namespace ivory
