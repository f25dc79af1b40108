// What an environment's light amounts to on surfaces: its moments, and its irradiance for every normal.
#pragma once

#include "grid/env/difmap.h"
#include "grid/env/environment_image.h"
#include "grid/env/irradiance/tree.h"
#include "grid/env/moments.h"

namespace ivory {

// One pass over the texels, each integrated exactly (see grid/env/moments.h) in the layout that the file has. On all of
// TBB's threads; the sums run in a fixed order, so the bits do not depend on their number.
RadianceMoments radiance_moments(const EnvironmentImage& image);

// The light sorted for exact irradiance; maps coarser than 256 rows (128 on a cube's face) are divided further, so that
// every texel counts with its true extent.
IrradianceTree make_irradiance_tree(const EnvironmentImage& image);

struct IrradianceMap {
  CubeMap e;        // lux, for the normals of the texels' centres
  V3d error_bound;  // largest over all texels of the bound that the tree gives, lux
};
// For the normals of `size` x `size` texels a face, size >= 1. On all of TBB's threads.
IrradianceMap bake_irradiance(const IrradianceTree& tree, int size);

}  // namespace ivory
