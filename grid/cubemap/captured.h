// From a finely captured cube map to a localized one of a few texels.
#pragma once

#include <vector>

#include "grid/base/names.h"
#include "grid/cubemap/localized.h"

namespace ivory {

// What is seen from a point: radiance, and the distance to what is seen through each texel's centre.
struct CapturedCube {
  V3f origin_m{0, 0, 0};
  V3d anchor_m{0, 0, 0};                // origin_m plus this is in the world
  CubeMap radiance;                     // nits
  std::vector<float> inverse_distance;  // 1/m, 0 for the sky; as radiance.texels
};

// How the shell's vertices are placed.
enum class ShellFit {
  fitted,    // least squares of inverse distance over all that was captured
  corners,   // at the distance captured right there
  averaged,  // as published: mean distance of the texels that share the vertex
};
template <>
inline constexpr auto name_table<ShellFit> = make_name_table<ShellFit>("way to place a shell",
                                                                       {{ShellFit::fitted, "fitted"},
                                                                        {ShellFit::corners, "corners"},
                                                                        {ShellFit::averaged, "averaged"}});

// A cube of `size` texels along an edge, which must divide the captured size; texels hold the mean radiance over their
// solid angle, nits.
LocalizedCube localize(const CapturedCube& captured, int size, ShellFit fit = ShellFit::fitted);

}  // namespace ivory
