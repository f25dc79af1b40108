// How far an environment's baked irradiance is from the environment's own, over all normals.
#pragma once

#include <cstdint>
#include <vector>

#include "grid/base/measured_error.h"
#include "grid/env/cube_map.h"
#include "grid/env/environment_image.h"
#include "grid/env/irradiance/tree.h"
#include "grid/env/sh9.h"

namespace ivory {

struct IrradianceTruth {
  std::vector<V3d> n;  // unit
  std::vector<V3d> e;  // lux
};
// At `count` normals drawn uniformly over the sphere. On all of TBB's threads; the bits do not depend on their number.
// By the tree, whose cells at the horizon are as coarse as the map's texels: fast, and as good as what is baked from
// it.
IrradianceTruth make_irradiance_truth(const IrradianceTree& tree, int count, std::uint64_t seed);
// By sum_irradiance(), which divides the texels that the horizon cuts: the last word.
IrradianceTruth sum_irradiance_truth(const EnvironmentImage& image, int count, std::uint64_t seed);

// RMS of E over the truth's normals and the three channels ÷ mean E there, as bilinear() and irradiance_polynomial()
// (never negative) read it.
MeasuredError difmap_error(const CubeMap& e, const IrradianceTruth& truth);
MeasuredError sh9_rms_error(const Sh9& sh, const IrradianceTruth& truth);

// difmap_error() of the map that bake_irradiance() would give for `size`, of which only those texels are made that the
// truth's normals read.
MeasuredError predicted_difmap_error(const IrradianceTree& tree, int size, const IrradianceTruth& truth);

}  // namespace ivory
