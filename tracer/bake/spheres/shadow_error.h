// Shadows of a sphere set against those of the mesh that it stands for.
#pragma once

#include <cstdint>
#include <vector>

#include "grid/base/measured_error.h"
#include "grid/lobes/sphere_set.h"
#include "tracer/core/scene.h"

namespace ivory {

// Receivers lie between these distances from the centre of the mesh's bounding sphere, in its radii, evenly in the
// logarithm; each looks at a distant lamp of that half-angle (a lamp a quarter as wide as it is far) with a point of
// the bounding sphere's inside before its middle.
inline constexpr double nearest_shadow_receiver = 1;
inline constexpr double farthest_shadow_receiver = 3;
inline constexpr double shadow_lamp_half_angle_rad = 0.125;

struct ShadowTruth {
  struct Receiver {
    V3f p;                     // in bounding radii about the sphere's centre
    V3f axis;                  // unit, towards the middle of the lamp
    std::vector<bool> hidden;  // of its rays
  };
  std::vector<Receiver> receivers;
  int rays = 0;  // of each of two independent halves
  std::uint64_t seed = 0;
  V3f center_m{0, 0, 0};  // of the bounding sphere, in the scene
  float radius_m = 1;
};

struct ShadowTruthParams {
  int receivers = 1000;
  int rays = 128;  // a half, a power of two
  std::uint64_t seed = 1;
};

// What `scene`, all of it but spherical lights, hides. On all of TBB's threads; the bits do not depend on their number.
// Throws Error where it has no triangles or no extent.
ShadowTruth trace_shadow_truth(const Scene& scene, const ShadowTruthParams& params);

// RMS over the receivers of the error of the share of the lamp that is hidden, that is, of E ÷ the unshadowed E. The
// set goes by the scene's anchor.
MeasuredError shadow_error(const SphereSet& set, const ShadowTruth& truth);

}  // namespace ivory
