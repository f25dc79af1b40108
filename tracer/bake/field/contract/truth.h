// E at points by path tracing, with what its own noise is worth.
#pragma once

#include <cstdint>

#include "tracer/core/lit_scene.h"

namespace ivory {

struct TruthParams {
  int max_bounces = 1000;  // surfaces that light may scatter at on its way to the point
  bool indirect_only = true;
  std::uint64_t seed = 1;
};

struct Truth {
  V3d e{0, 0, 0};         // lux per channel
  V3d variance{0, 0, 0};  // of e, an unbiased estimate
};

// Of the channels.
inline double mean_of(const V3d& rgb) { return (rgb.x + rgb.y + rgb.z) / 3; }

// Paths are traced in groups whose random numbers cover their ranges evenly; groups are independent of each other, and
// the spread of their means is what tells the variance.
inline constexpr int truth_groups = 16;

// From at least `paths` paths, a multiple of truth_groups. Depends on nothing but the scene, the parameters and the
// point's number.
Truth trace_truth(const LitScene& lit, const V3f& p, const V3f& n, int paths, std::uint64_t index,
                  const TruthParams& params);

// How many paths a point are best where a path's E varies by `path_variance` and the square error sought is `square`
// (lux^2), the number of all paths being given: with K paths of standard deviation s at each of N points where an asset
// is off by d, the square's estimate varies by 2 s^4 / K^2 + 4 d^2 s^2 / K + C d^4, C the square of the coefficient of
// variation of d^2 over the points: about 9 where a tenth of them holds 70 % of the sum. For a given N K that is least
// at K = sqrt(2 / C) s^2 / d^2.
double best_paths(double path_variance, double square);

// Does one of so many paths bring light to the point? Their numbers are others than those of trace_truth(), so that a
// truth is not chosen by its own value.
bool light_reaches(const LitScene& lit, const V3f& p, const V3f& n, int paths, std::uint64_t index,
                   const TruthParams& params);

}  // namespace ivory
