#include "grid/field/mix.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "grid/base/certificate.h"
#include "grid/base/error.h"

namespace ivory {

namespace {

std::string names_of(const IrradianceGrid& grid) {
  std::string names;
  for (const GridGroup& group : grid.groups) names += (names.empty() ? "" : ", ") + group.name;
  return names;
}

void check(const IrradianceGrid& grid, const GroupFactors& factors) {
  if (grid.groups.empty()) throw ParameterError("groups", "the grid keeps no groups of lights apart");
  for (const auto& [name, factor] : factors) {
    if (std::ranges::find(grid.groups, name, &GridGroup::name) == grid.groups.end())
      throw ParameterError("groups", "there is no '" + name + "' among " + names_of(grid));
    for (unsigned c = 0; c < 3; ++c) {
      if (!(factor[c] >= 0) || !std::isfinite(factor[c]))
        throw ParameterError("groups", "the factor of '" + name + "' is negative or not finite");
    }
  }
}

}  // namespace

IrradianceGrid mix_groups(const IrradianceGrid& grid, const GroupFactors& factors) {
  check(grid, factors);
  const bool as_baked = std::ranges::all_of(factors, [](const auto& f) { return f.second == Rgb(1, 1, 1); });
  IrradianceGrid mixed{grid, as_baked ? static_cast<const StoredMoments&>(grid) : StoredMoments{}, {}};
  mixed.metadata.erase(light_groups_key);
  mixed.metadata.erase(lamp_groups_key);
  if (as_baked) return mixed;
  remove_certificate(mixed.metadata);

  const auto stride = std::size_t(grid.stride());
  mixed.moments.assign(grid.moments.size(), 0.0F);
  mixed.variance.assign(grid.variance.size(), Rgb(0, 0, 0));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, grid.variance.size(), 1024), [&](const auto& vertices) {
    for (const GridGroup& group : grid.groups) {
      const auto found = factors.find(group.name);
      const Rgb factor = found == factors.end() ? Rgb(1, 1, 1) : found->second;
      for (std::size_t v = vertices.begin(); v < vertices.end(); ++v) {
        for (std::size_t i = 0; i < stride; ++i)
          mixed.moments[v * stride + i] += factor[unsigned(i % 3)] * group.moments[v * stride + i];
        mixed.variance[v] += factor * factor * group.variance[v];
      }
    }
  });
  return mixed;
}

}  // namespace ivory
