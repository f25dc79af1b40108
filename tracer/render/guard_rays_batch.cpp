#include "tracer/render/guard_rays_batch.h"

#include <cassert>

#include "grid/field/batch/blocks.h"
#include "grid/field/lookup.h"
#include "tracer/render/guard_rays.h"

namespace ivory {
namespace {

// Which corners each point sees, bit by bit: the rays of one look-up go to Embree together, as in visible_by_rays().
// More of them at once, those of other points, take longer a ray: 8, 16 and 64 took 232, 359 and 382 ns a point in two
// rooms.
Eight<std::uint32_t> visible_by_rays(const GridFrame& frame, const Intersector& intersector, const EightPoints& points,
                                     const Corners& corners) {
  Eight<std::uint32_t> visible{};
  for (std::size_t i = 0; i < points_at_once; ++i) {
    LookupPoint at{.p = V3f(0, 0, 0), .nudge_voxels = points.nudge_voxels, .most_m = points.most_m[i]};
    V3f base;
    for (unsigned axis = 0; axis < 3; ++axis) {
      at.p[axis] = points.p[axis][i];
      at.ng[axis] = points.ng[axis][i];
      base[axis] = corners.base[axis][i];
    }
    std::array<V3f, 8> targets;
    std::array<std::uint32_t, 8> corner_of{};
    int filled = 0;
    for (std::uint32_t c = 0; c < 8; ++c) {
      if (corners.weight[c][i] == 0 || corners.fraction[c][i] <= 0) continue;
      targets[std::size_t(filled)] = frame.to_world(base + V3f(float(c & 1U), float(c >> 1U & 1U), float(c >> 2U)));
      corner_of[std::size_t(filled++)] = c;
    }
    if (filled == 0) continue;
    const std::uint32_t bits = intersector.visible(at.nudged(frame), targets, filled);
    for (std::size_t k = 0; k < std::size_t(filled); ++k) visible[i] |= (bits >> k & 1U) << corner_of[k];
  }
  return visible;
}

ReadBlock read_by_rays(const IrradianceGrid& grid, const Intersector& intersector, const LookupParams& params) {
  return
      [&grid, &intersector, params](std::span<const V3f> p, std::span<const V3f> ng, std::span<Footprint> footprints) {
        const auto reread = [&](std::size_t i) { return lookup_footprint(grid, &intersector, p[i], ng[i], params); };
        if (params.interpolation != Interpolation::trilinear) {
          for (std::size_t i = 0; i < p.size(); ++i) footprints[i] = reread(i);
          return;
        }
        std::array<LookupPoint, points_a_block> at;
        for (std::size_t i = 0; i < p.size(); ++i) at[i] = point_by_rays(grid, intersector, p[i], ng[i], params);
        const auto read_level = [&](int level, const EightPoints& points) {
          Corners corners = make_corners(grid, level, points);
          restrict_corners(visible_by_rays(grid.frame_of(level), intersector, points, corners), corners);
          return corners;
        };
        read_levels(grid, std::span(at).first(p.size()), enough_weight, read_level, reread, footprints);
      };
}

}  // namespace

std::vector<Rgb> lookup_irradiance(const IrradianceGrid& grid, const Intersector* intersector, const LookupSpans& at,
                                   std::span<const V3f> n, const LookupParams& params) {
  if (params.guard != Guard::rays) return lookup_irradiance(grid, at, n, params);
  assert(intersector != nullptr);
  return read_irradiance(grid, at, n, params.reconstruction, read_by_rays(grid, *intersector, params));
}

std::vector<GridReading> lookup_readings(const IrradianceGrid& grid, const Intersector* intersector,
                                         const LookupSpans& at, std::span<const V3f> n, const LookupParams& params,
                                         float unmet_lux) {
  if (params.guard != Guard::rays) return lookup_readings(grid, at, n, params, unmet_lux);
  assert(intersector != nullptr);
  return read_readings(grid, at, n, params.reconstruction, unmet_lux, read_by_rays(grid, *intersector, params));
}

}  // namespace ivory
