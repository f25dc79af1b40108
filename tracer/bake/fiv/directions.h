// An environment as parallel lights, in the order that FIV baking wants them.
#pragma once

#include <array>
#include <vector>

#include "grid/env/cube_map.h"
#include "grid/fiv/table.h"

namespace ivory {

struct FivDirections {
  std::vector<V3f> w;                         // unit, towards the light; sorted by octant, then from bright to dim
  std::vector<Rgb> power;                     // L dw, lux facing it
  std::array<std::size_t, 9> octant_begin{};  // directions of octant o are [octant_begin[o], octant_begin[o + 1])
};

// One light a texel, from its centre. Bit i of an octant is set where w_i < 0.
FivDirections make_fiv_directions(const CubeMap& environment);

// The texels of `fine`, merged by blocks into those of a cube of `size` texels (which must divide fine's), but left
// apart as far as that keeps each light under 1 / `parts` of all light: a bright window is many lights that cast soft
// shadows together, a dull ceiling few. A merged light comes from the centre of its block.
FivDirections make_fiv_directions(const CubeMap& fine, int size, int parts);

// At most 6 `size`^2 lights for environments of any size: merged by blocks where `size` divides the environment's,
// otherwise resampled to `size` texels by the areas that texels share; one of fewer texels stays as it is.
FivDirections make_fiv_pilot_directions(const CubeMap& environment, int size);

// Splits off the lights that carry more than 1 / `parts` of all light each.
struct SplitDirections {
  FivDirections bright;
  FivDirections rest;
};
SplitDirections split_bright(const FivDirections& directions, int parts);

// Sums of L w dw over the hidden directions of each octant [octant][xyz][rgb] to moments: F is their sum, and D_i
// (the difference of the two hemispheres about axis i) their sum with the octants' signs.
FivMoments fold_octants(const std::array<float, 72>& octants, int hemispheres);

// Moments of all the light.
FivMoments total_moments(const FivDirections& directions);

}  // namespace ivory
