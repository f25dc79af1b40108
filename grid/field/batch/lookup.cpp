#include "grid/field/batch/lookup.h"

#include <cassert>

#include "grid/field/batch/blocks.h"
#include "grid/field/lookup.h"

namespace ivory {

namespace {

ReadBlock read_by(const IrradianceGrid& grid, const LookupParams& params) {
  assert(params.guard != Guard::rays);
  const bool by_planes = params.guard == Guard::planes && !grid.guard.empty();
  return [&grid, params, by_planes](std::span<const V3f> p, std::span<const V3f> ng, std::span<Footprint> footprints) {
    const auto reread = [&](std::size_t i) { return lookup_footprint(grid, p[i], ng[i], params); };
    if (params.interpolation != Interpolation::trilinear) {
      for (std::size_t i = 0; i < p.size(); ++i) footprints[i] = reread(i);
      return;
    }
    std::array<LookupPoint, points_a_block> at;
    for (std::size_t i = 0; i < p.size(); ++i) at[i] = {.p = p[i], .ng = ng[i], .nudge_voxels = params.nudge_voxels};
    const auto read_level = [&](int level, const EightPoints& points) {
      if (by_planes) return read_near(grid, level, points);
      Corners corners = make_corners(grid, level, points);
      Eight<std::uint32_t> all;
      all.fill(0xFF);
      restrict_corners(all, corners);
      return corners;
    };
    // Without a guard only points that no vertex answers are left to the look-up one by one.
    const float least_kept = params.guard == Guard::planes ? enough_weight : least_weight;
    read_levels(grid, std::span(at).first(p.size()), least_kept, read_level, reread, footprints);
  };
}

}  // namespace

std::vector<Rgb> lookup_irradiance(const IrradianceGrid& grid, const LookupSpans& at, std::span<const V3f> n,
                                   const LookupParams& params) {
  return read_irradiance(grid, at, n, params.reconstruction, read_by(grid, params));
}

std::vector<GridReading> lookup_readings(const IrradianceGrid& grid, const LookupSpans& at, std::span<const V3f> n,
                                         const LookupParams& params, float unmet_lux) {
  return read_readings(grid, at, n, params.reconstruction, unmet_lux, read_by(grid, params));
}

}  // namespace ivory
