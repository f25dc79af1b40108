// Light around a reference point, path-traced: what a localized cube map is judged by.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "grid/base/measured_error.h"
#include "grid/cubemap/localized.h"
#include "tracer/core/lit_scene.h"

namespace ivory {

struct CubeReceiver {
  V3f p;  // of the scene, between the reference point and what is seen from it
  V3f n;  // unit, uniform over the sphere
  // E but for what comes straight from punctual lights, lux: two independent estimates, so that the product of what
  // they leave of an error has none of their noise.
  std::array<V3d, 2> e;
};

struct CubeTruth {
  std::vector<CubeReceiver> receivers;
  double reach_m = 0;  // from the reference point, at most
  int dazzled = 0;     // receivers left out: see most_of_mean
};

// Where E is above so many times its mean a receiver stands right before a lamp, where few of them come to lie and each
// outweighs hundreds; it is left out.
inline constexpr double most_of_mean = 5;

struct CubeTruthParams {
  int receivers = 1000;
  int paths = 1024;  // of each estimate
  std::uint64_t seed = 1;
};

// Receivers lie where an object may move to near `origin`: along directions uniform over the sphere, evenly by volume
// up to 98 % of the way to the first surface, but no farther than three times the harmonic mean of all distances to
// first surfaces, which is that of the walls of a room. 1 m where there is none. On all of TBB's threads; the bits do
// not depend on their number.
CubeTruth trace_cube_truth(const LitScene& lit, const V3f& origin, const CubeTruthParams& params);

// RMS of the error of E over receivers and channels ÷ mean E, read as polygons.
MeasuredError cube_error(const LocalizedCube& cube, const CubeTruth& truth);

}  // namespace ivory
