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

// Paths are traced in groups whose random numbers cover their ranges evenly; groups are independent of each other, and
// the spread of their means is what tells the variance.
inline constexpr int truth_groups = 16;

// From at least `paths` paths, a multiple of truth_groups. Depends on nothing but the scene, the parameters and the
// point's number.
Truth trace_truth(const LitScene& lit, const V3f& p, const V3f& n, int paths, std::uint64_t index,
                  const TruthParams& params);

// Does one of so many paths bring light to the point? Their numbers are others than those of trace_truth(), so that a
// truth is not chosen by its own value.
bool light_reaches(const LitScene& lit, const V3f& p, const V3f& n, int paths, std::uint64_t index,
                   const TruthParams& params);

}  // namespace ivory
