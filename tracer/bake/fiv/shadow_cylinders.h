// Which positions an object darkens in parallel light: for light from direction w these form a cylinder
// along w, cut off by the object itself. A picture of the object seen along w that keeps the largest
// depth describes all of it: position q is dark where the object reaches farther towards the light than q,
// on q's line along w. One ray a pixel thus answers for every position, however many there are.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "tracer/core/intersector.h"
#include "tracer/core/sampling.h"

namespace ivory {

// The pictures of a run of directions.
struct ShadowCylinders {
  int resolution = 0;                // pixels along a side of the square [-1, 1]^2 about the origin
  std::vector<ShadingFrame> frames;  // z towards the light, x and y along the picture's columns and rows
  std::vector<float> depth;          // w x rows x columns: largest q.w on the object, no_depth beside it
  static constexpr float no_depth = -std::numeric_limits<float>::infinity();
};

// The object must lie within the unit sphere about the origin. Parallel over the directions.
ShadowCylinders trace_shadow_cylinders(const Intersector& object, std::span<const V3f> w, int resolution);

// Share of the picture's inscribed disc that the object covers, over all directions.
double covered_share(const ShadowCylinders& cylinders);

}  // namespace ivory
