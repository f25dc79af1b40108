// Where photons are wanted, while they are elsewhere.
//
// Light that falls on the ground around a room and bounces into it comes by few photons, each of much power: most leave
// for the sky. So where a photon of the power P scatters outside the box about the grid, n more pieces of it are sent
// at the box. With p_b(w) the density of the piece that scatters as ever and p_c(w) that of the pieces sent, each
// carries
//
//   P f(w) cos / (p_b(w) + n p_c(w)),
//
// whichever it is (Veach's balance heuristic): together they are right in the mean, and none carries more than the one
// piece would. n is chosen before the directions are, so that a piece carries about what is sought; below one it is the
// odds of sending one at all.
#pragma once

#include <array>

#include "grid/field/frame.h"

namespace ivory {

struct PhotonAim {
  GridFrame frame;      // its cells are the box
  float sought_lm = 0;  // strongest channel that a piece should carry; 0: what its photon set out with
};

// The box as seen from a point outside it: evenly chosen points of the faces that it shows. In the frame's axes.
struct AimedBox {
  V3f p;  // from the box's least corner, metres
  V3f extent_m;
  std::array<float, 3> face_m2{};  // of the face shown along each axis; 0: none is
  std::array<bool, 3> upper{};     // which of the two it is
  float area_m2 = 0;
  float solid_angle = 0;  // about; sr
};
// area_m2 is 0 for a point inside, or so close to a face that it need not be aimed.
AimedBox aim(const PhotonAim& aim, const V3f& p);

// A unit direction, world, to a point of the faces shown.
V3f sample(const PhotonAim& aim, const AimedBox& box, float u_face, const V2f& u);
// Density of that, 1/sr; 0 for directions that miss the faces.
float pdf_solid_angle(const PhotonAim& aim, const AimedBox& box, const V3f& w);

}  // namespace ivory
