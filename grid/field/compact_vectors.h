// The compact form of six hemispherical irradiance vectors (RR-6983 section 4.2): the three colour channels of a
// hemisphere share one direction, so that it takes three norms and that direction instead of nine numbers. It loses
// what the channels' directions differ by; see runtime/assets/irradiance_grid.h for how much.
#pragma once

#include <array>
#include <span>

#include "grid/field/basis.h"

namespace ivory {

// [norms of hemisphere +x,-x,+y,-y,+z,-z][rgb], then [direction of the same][xyz]: 36 floats from the 36 moments of
// Basis::vectors. Norms are in lux; directions are unit vectors, or zero for a hemisphere without light.
std::array<float, 36> compact_from_moments(std::span<const float, 36> moments);

// And back, to read them at the unit normal n. Directions need not be unit vectors, so that weighted sums of several
// vertices can be given: a sum's direction is the mean direction, its norms the mean norms. Each axis states the full
// vector F anew, as I_+ + I_-, and rounded differently: n_i^2 weighs them, so that at an axis E is what its own
// hemisphere says. Measured, that halves the error of their plain mean.
std::array<float, 36> moments_from_compact(std::span<const float, 36> compact, const V3f& n);

}  // namespace ivory
