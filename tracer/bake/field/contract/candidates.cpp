#include "tracer/bake/field/contract/candidates.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "grid/base/error.h"

namespace ivory {

double spacing_of(const GridFrame& frame) {
  const V3f& h = frame.spacing_m;
  return std::cbrt(double(h.x) * h.y * h.z);
}

double layers_of(const GridFrame& frame) { return std::max({frame.size.x, frame.size.y, frame.size.z}); }

double longest_m(const GridFrame& frame) {
  const V3f extent = V3f(frame.size) * frame.spacing_m;
  return std::max({extent.x, extent.y, extent.z});
}

GridFrame covering_frame(const Scene& scene, GridBakeParams params) {
  params.voxel_size_m.reset();
  params.resolution = V3i(2, 2, 2);
  return default_frame(scene, params);
}

int levels_for(double layers, Estimator estimator) {
  constexpr double coarsest = 12;
  constexpr int most = 6;
  if (estimator != Estimator::track) return 1;
  return std::clamp(1 + int(std::floor(std::log2(layers / coarsest))), 1, most);
}

GridCandidates make_candidates(const Scene& scene, const GridBakeParams& asked, const GridFrame& cover) {
  GridCandidates candidates;
  if (asked.resolution || asked.voxel_size_m || asked.frame) {
    candidates.list = {{asked, default_lattice(scene, asked)}};
    candidates.limited_by = "the spacing, which is given";
    return candidates;
  }
  const double limit = memory_limit_bytes(asked);
  for (int quarter = 0;; ++quarter) {
    GridCandidate c{asked, {}};
    const double layers = coarsest_layers * std::exp2(quarter / 4.0);
    constexpr double hair = 1 + 1e-6;  // less than one voxel over
    c.bake.voxel_size_m = float(longest_m(cover) * hair / layers);
    c.bake.levels = levels_for(layers, asked.estimator);
    try {
      c.lattice = default_lattice(scene, c.bake);
    } catch (const ParameterError&) {
      candidates.limited_by = "the number of vertices that a grid may have";
      break;
    } catch (const Error&) {
      candidates.limited_by = fmt::format("memory of {:.3g} GiB", limit / 1073741824.0);
      break;
    }
    if (grid_memory_bytes(c.lattice, c.bake, 1) > limit) {
      candidates.limited_by = fmt::format("memory of {:.3g} GiB", limit / 1073741824.0);
      break;
    }
    candidates.list.push_back(c);
  }
  if (candidates.list.empty()) {  // even the coarsest is too much: says so by itself
    const Lattice usual = default_lattice(scene, asked);
    check_grid_memory(scene, usual, asked);
    candidates.list = {{asked, usual}};
  }
  return candidates;
}

}  // namespace ivory
