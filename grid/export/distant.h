// Distant light on its way to other engines: what they take is nine coefficients or a cube of E / pi.
#pragma once

#include <functional>

#include "grid/env/cube_map.h"
#include "grid/env/difmap.h"
#include "grid/env/sh9.h"

namespace ivory {

struct DistantLight {
  Sh9 sh;
  std::function<Rgb(const V3f& n)> e;  // E(n) in lux, as the asset has it; n a unit vector
  int size = 0;                        // of the faces of the map that it came from; 0: from nine coefficients
  // What nine coefficients lose of it: RMS over normals and channels of the difference in E, over mean E; 0 where it
  // came from nine.
  double sh_loss = 0;
  Metadata metadata;
};

DistantLight distant_light(const Sh9& sh, const Metadata& metadata);

// With the nine coefficients that are nearest to the map in mean square over all normals.
DistantLight distant_light(const DifMap& map);

// The faces of a cube map as graphics cards sample it (OpenGL, Vulkan, WebGPU, D3D alike; KTX's order and orientation):
// face, row, column with the first row at the top. texel(d) answers for the unit direction d that a shader samples.
std::vector<Rgb> gpu_cube(int size, const std::function<Rgb(const V3f& d)>& texel);

// The light that a fully rough mirror reflects, E / pi in nits, as the mean over all normals.
Rgb mean_radiance(const DistantLight& light);

}  // namespace ivory
