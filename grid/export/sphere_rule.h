// A quadrature rule over the sphere: Gauss-Legendre along z times even steps around it.
#pragma once

#include <span>

#include "grid/base/types.h"

namespace ivory {

struct SphereNode {
  V3d direction;
  double weight = 0;  // sr; 4 pi in all
};

// 12 x 24 directions: exact for polynomials of the direction up to degree 23 along z and below 24 around it, and so for
// what two bands of harmonics and E of three bands multiply to.
std::span<const SphereNode> sphere_rule();

}  // namespace ivory
