// Localized cube maps as files.
#pragma once

#include <string>

#include "grid/cubemap/localized.h"

namespace ivory {

// An OpenEXR cube environment map of 32-bit floats, 6 size rows of size texels, kind "cubemap":
//   R, G, B                            mean radiance over the texel, nits
//   inverse_distance.00 .10 .01 .11    1 / distance from the reference point to the shell at the texel's four corners
//                                      (right, down), 1/m; 0: sky. Texels that share a corner hold the same.
// and the attribute ivory:position_m, the reference point in the world.
// Throws Error where the file exists and not `force`, or cannot be written.
void write_localized_cube(const std::string& path, const LocalizedCube& cube, bool force);

// Throws Error for files of another kind or size, damaged ones, and shells that are not closed.
LocalizedCube read_localized_cube(const std::string& path);

}  // namespace ivory
