// E at many points of a grid at once, guarded by rays: as grid/field/batch/lookup.h, whose functions these are for
// every guard. Answers are those of guard_rays.h to the last bit.
#pragma once

#include "grid/field/batch/lookup.h"
#include "tracer/core/intersector.h"

namespace ivory {

// `intersector` may be null unless params.guard is rays.
std::vector<Rgb> lookup_irradiance(const IrradianceGrid& grid, const Intersector* intersector, const LookupSpans& at,
                                   std::span<const V3f> n, const LookupParams& params);
std::vector<GridReading> lookup_readings(const IrradianceGrid& grid, const Intersector* intersector,
                                         const LookupSpans& at, std::span<const V3f> n, const LookupParams& params,
                                         float unmet_lux = 0);

}  // namespace ivory
