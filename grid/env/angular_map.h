// Angular maps (light probes): the whole sphere in a disc, its centre looking at +Z, angle from there proportional to
// radius; the rim is -Z. Up in the image is +Y, +X lies to the left, as in the middle of a lat-long map: never
// mirrored. Texels outside the disc count zero.
#pragma once

#include <vector>

#include "grid/base/types.h"

namespace ivory {

struct AngularMap {
  int size = 0;             // texels along an edge; the disc touches all four
  std::vector<Rgb> texels;  // size * size: row, column
};

// Direction of a point of the disc: u to the right, v down, each in [-1, 1], radius at most 1.
V3d angular_direction(double u, double v);

// Index of the texel that w (unit) falls in.
std::size_t angular_texel(int size, const V3f& w);

// Points of a texel and the solid angle that each stands for: integrals over the texel's part of the disc by the 3 x 3
// Gauss rule, with the Jacobian dw = pi^2 sin(theta)/theta du dv, smooth over the disc, rim and centre included. Texels
// that the rim cuts are divided into 8 x 8 midpoints; their weight vanishes with sin(theta) at the rim. The weights of
// all texels sum to 4 pi within 1e-4 for a size of 16, 1e-6 from 128 on.
struct AngularNode {
  V3d w;
  double solid_angle;
};
std::vector<AngularNode> angular_nodes(int size, int row, int column);

}  // namespace ivory
