// The light that an occluder hides, traced at receivers around it: what its table is judged by.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "grid/base/measured_error.h"
#include "grid/env/irradiance/tree.h"
#include "grid/env/latlong_map.h"
#include "grid/fiv/table.h"
#include "tracer/bake/fiv/occluder.h"

namespace ivory {

// Receivers lie on planes that the mesh wholly lies on one side of, as floors and walls do: this far beyond the mesh,
// in bounding radii, evenly in the logarithm, and as far as farthest_aside from the foot of the occluder's centre,
// evenly. Nearer by, contact shadows are finer than any table; between a mesh's own limbs light is its own affair.
inline constexpr double nearest_fiv_gap = 0.02;
inline constexpr double farthest_fiv_gap = 2;
inline constexpr double farthest_aside = 2;

struct FivReceiver {
  V3f p;           // relative to the occluder's centre, in bounding radii
  V3f n;           // unit, uniform over the sphere
  Rgb unshadowed;  // E without the occluder, lux
  // E that the occluder takes, lux: two independent estimates, so that the product of what they leave of an error has
  // none of their noise.
  std::array<V3d, 2> hidden;
};

struct FivTruth {
  std::vector<FivReceiver> receivers;
  double mean_unshadowed = 0;  // over all normals and the channels, lux
};

struct FivTruthParams {
  int receivers = 1000;
  int samples = 512;  // directions of each estimate, a power of two
  std::uint64_t seed = 1;
};

// `map` and `tree` hold the same environment. On all of TBB's threads; the bits do not depend on their number.
FivTruth trace_fiv_truth(const FivOccluder& occluder, const EnvironmentMap& map, const IrradianceTree& tree,
                         const FivTruthParams& params);

// RMS of the error of E over receivers and channels ÷ mean unshadowed E, where fiv_irradiance() reads the table for one
// occluder with its defaults.
MeasuredError fiv_error(const FivTable& table, const FivTruth& truth);

}  // namespace ivory
