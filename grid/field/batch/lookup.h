// E at many points of a grid at once: eight side by side in vector registers, where lookup.h takes one after the other.
// Answers are those of lookup.h to the last bit, whatever the order and number of points. One thread works at a call;
// parts of the points may be given to several. With rays in place of the planes: tracer/render/guard_rays.h.
#pragma once

#include <span>
#include <vector>

#include "grid/field/irradiance_grid.h"

namespace ivory {

// Where E is wanted, by [point]: places on surfaces (as the grid's frame counts them: world, m, less the anchor) and
// unit geometric normals on the lit side, 0 in free space. As many of both.
struct LookupSpans {
  std::span<const V3f> p;
  std::span<const V3f> ng;
};

// [point] E in lux at the points for the unit shading normals n, as lookup_irradiance() of lookup.h. params.guard is
// planes or off. Throws as irradiance() does.
std::vector<Rgb> lookup_irradiance(const IrradianceGrid& grid, const LookupSpans& at, std::span<const V3f> n,
                                   const LookupParams& params);

struct GridReading {
  Rgb e{0, 0, 0};               // lux
  Rgb standard_error{0, 0, 0};  // as irradiance_standard_error() with `unmet_lux`
  bool seen = false;            // by any vertex
  bool met = false;             // did a photon come to any vertex that was read?
};
std::vector<GridReading> lookup_readings(const IrradianceGrid& grid, const LookupSpans& at, std::span<const V3f> n,
                                         const LookupParams& params, float unmet_lux = 0);

}  // namespace ivory
