// Baking FIV occluder tables (grid/fiv/table.h).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "grid/env/cube_map.h"
#include "grid/fiv/table.h"
#include "tracer/bake/fiv/occluder.h"
#include "tracer/core/intersector.h"

namespace ivory {

struct FivParams {
  V3i samples{128, 65, 30};     // azimuth, polar angle, distance
  int hemispheres = 1;          // 1 or 6
  int environment_size = 32;    // texels along a cube face that dim parts of the environment are merged to; must divide
                                // the environment's
  int parts = 4096;             // brighter parts stay apart until none carries more than 1 / parts of all light
  float farthest = 8;           // the outermost sphere, in bounding radii
  std::vector<float> radii;     // the spheres over the bounding radius, samples.z of them; empty: chosen by fiv_radii()
  int silhouette_pixels = 128;  // along a side of the pictures that tell which positions are dark
  bool fit = true;          // least-squares values (tracer/bake/fiv/fit.h); otherwise those at the samples themselves
  bool fill_inside = true;  // see bake_fiv()
  IntersectorParams intersector;
  std::function<void(std::size_t, std::size_t)> progress;  // called now and then: directions done, of all
};

// The table of `occluder` under `environment`. Samples that stand inside the mesh take the mean of their neighbours
// outside, so that interpolation near the surface is not darkened by what nobody can see. Results do not depend on
// threads. Throws ParameterError where params.environment_size does not divide the environment's.
FivTable bake_fiv(const FivOccluder& occluder, const CubeMap& environment, const FivParams& params);

// A table for each of `sizes`, the same as bake_fiv() gives with these samples and no radii, in little more time than
// for the finest of them: all read the same pictures of the occluder.
std::vector<FivTable> bake_fivs(const FivOccluder& occluder, const CubeMap& environment, const FivParams& params,
                                std::span<const V3i> sizes);

// For each of `counts` so many distances in bounding radii, from beside the mesh to params.farthest, so that every
// interval adds the same interpolation error: the density follows the root of the second derivative over the logarithm
// of distance, measured in a small bake of many spheres.
std::vector<std::vector<float>> fiv_radii(const FivOccluder& occluder, const CubeMap& environment,
                                          const FivParams& params, std::span<const int> counts);

}  // namespace ivory
