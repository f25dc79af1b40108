// Sums of the light that an occluder hides from many positions.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tracer/bake/fiv/directions.h"
#include "tracer/core/intersector.h"

namespace ivory {

// Positions of a table's samples in bounding radii, relative to the occluder's centre: distance x polar x azimuth.
std::vector<V3f> fiv_sample_positions(const V3i& size, const std::vector<float>& radii);

struct FivSums {
  std::vector<float> values;          // position x functions x rgb, as in FivTable
  std::vector<std::uint32_t> hidden;  // position: how many directions are hidden
  double coverage = 0;                // mean share of the unit disc that the object fills, seen along the directions
};

// `object` must lie within the unit sphere. Which positions are dark in the light of a direction is told by pictures
// of silhouette_pixels^2 (tracer/bake/fiv/shadow_cylinders.h), down to half as many a side for lights below the mean.
// Results do not depend on threads. `progress` is called with the directions done so far.
FivSums gather_fiv(const Intersector& object, const FivDirections& directions, const std::vector<V3f>& positions,
                   int hemispheres, int silhouette_pixels, const std::function<void(std::size_t)>& progress);

// The same by one occlusion ray per position and direction: the slow twin.
FivSums gather_fiv_by_rays(const Intersector& object, const FivDirections& directions,
                           const std::vector<V3f>& positions, int hemispheres);

}  // namespace ivory
