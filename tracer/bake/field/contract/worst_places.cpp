#include "tracer/bake/field/contract/worst_places.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "grid/base/anchor.h"
#include "tracer/core/sampling.h"
#include "tracer/core/surface.h"

namespace ivory {
namespace {

constexpr std::size_t most_places = 8;

// Does another surface stand within a voxel before it?
bool is_near_contact(const Intersector& intersector, const DomainPoint& at, float voxel_m) {
  const ShadingFrame frame = make_shading_frame(at.n);
  const V3f origin = offset_origin(at.p, at.n, at.n);
  constexpr int turns = 12;
  for (int i = 0; i < turns; ++i) {
    for (const float cosine : {0.1F, 0.5F}) {
      const V3f w = frame.to_world(direction_at_cosine(cosine, float(i) / turns));
      if (intersector.closest({.origin = origin, .direction = w, .t_max = voxel_m, .blocking_coverage = half_coverage}))
        return true;
    }
  }
  return false;
}

std::string cause_of(const LitScene& lit, const MeasuredPoint& m, const IrradianceGrid& grid) {
  const V3d off = m.reading.e - m.point.truth.e;
  const double square = off.length2() / 3;
  const V3f& h = grid.finest_frame().spacing_m;
  if (m.reading.unseen) return "no vertex sees it: a gap thinner than a voxel, or the grid ends";
  if (mean_of(m.reading.noise) > 0.25 * square) return "photon noise: too few photons come here";
  const V3d planes = m.reading.e_by_planes - m.point.truth.e;
  if (planes.length2() / 3 < 0.25 * square) return "vertices that rays leave out would help here";
  const V3f index = grid.frame.to_index(m.point.at.p);
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (index[axis] < -0.6F || index[axis] > float(grid.frame.size[axis]) - 0.4F) return "outside the grid";
  }
  if (is_near_contact(lit.intersector, m.point.at, std::max({h.x, h.y, h.z})))
    return "a contact or inner edge within a voxel";
  // Spread evenly over its bounds, E would be off by their width over the root of 12.
  if (m.reading.bracket / std::sqrt(12.0) > std::sqrt(square))
    return "light from few directions, which the basis blurs";
  return "light varies within a voxel";
}

}  // namespace

std::vector<WorstPlace> worst_places(const LitScene& lit, const std::vector<MeasuredPoint>& points,
                                     const IrradianceGrid& grid, double mean_e_lux) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a].sample.weight * points[a].sample.squared > points[b].sample.weight * points[b].sample.squared;
  });
  const V3f extent = V3f(grid.frame.size) * grid.frame.spacing_m;
  const V3f& h = grid.finest_frame().spacing_m;
  const float apart_m = std::max(2 * std::max({h.x, h.y, h.z}), 0.05F * extent.length());
  std::vector<WorstPlace> out;
  std::vector<V3f> taken;
  for (const std::size_t i : order) {
    if (out.size() == most_places) break;
    const MeasuredPoint& m = points[i];
    const double noise = mean_of(m.point.truth.variance);
    constexpr double sure = 9;  // three standard errors
    if (m.sample.squared <= (sure - 1) * noise) continue;
    const V3f& p = m.point.at.p;
    if (std::any_of(taken.begin(), taken.end(), [&](const V3f& q) { return (q - p).length() < apart_m; })) continue;
    taken.push_back(p);
    WorstPlace place;
    place.p_world = to_world(p, lit.scene->anchor_m);
    place.n = m.point.at.n;
    place.on_surface = m.point.at.on_surface;
    place.e_lux = mean_of(m.point.truth.e);
    place.read_lux = mean_of(m.reading.e);
    place.off = (place.read_lux - place.e_lux) / mean_e_lux;
    place.cause = cause_of(lit, m, grid);
    out.push_back(place);
  }
  return out;
}

}  // namespace ivory
