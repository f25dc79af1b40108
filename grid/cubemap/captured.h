// From a finely captured cube map to a localized one of a few texels.
#pragma once

#include <string_view>
#include <vector>

#include "grid/cubemap/localized.h"

namespace ivory {

// What is seen from a point: radiance, and the distance to what is seen through each texel's centre.
struct CapturedCube {
  V3f origin_m{0, 0, 0};
  CubeMap radiance;                     // nits
  std::vector<float> inverse_distance;  // 1/m, 0 for the sky; as radiance.texels
};

// How the shell's vertices are placed.
enum class ShellFit {
  fitted,    // least squares of inverse distance over all that was captured
  corners,   // at the distance captured right there
  averaged,  // as published: mean distance of the texels that share the vertex
};
std::string_view name(ShellFit fit);
ShellFit shell_fit_from_name(std::string_view name);

// Texels hold the mean radiance over their solid angle. `size` must divide the captured size.
LocalizedCube localize(const CapturedCube& captured, int size, ShellFit fit = ShellFit::fitted);

}  // namespace ivory
