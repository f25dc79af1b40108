#include "tools/view/session/groups.h"

#include <algorithm>
#include <iterator>
#include <sstream>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/view/session/lamps.h"
#include "tools/view/session/light.h"
#include "tools/view/world/model.h"

namespace ivory {

namespace {

const IrradianceGrid* grouped_grid(const ViewAsset& asset) {
  const auto* grid = std::get_if<GridAsset>(&asset.data);
  return grid == nullptr ? nullptr : grid->grouped.get();
}

std::vector<std::string> words_of(const Metadata& metadata, const char* key) {
  std::istringstream words(find_text(metadata, key).value_or(""));
  return {std::istream_iterator<std::string>(words), {}};
}

}  // namespace

std::vector<std::string> group_names(const ViewSession& session) {
  std::vector<std::string> names;
  for (const auto& asset : session.assets) {
    const IrradianceGrid* grid = grouped_grid(*asset);
    if (grid == nullptr) continue;
    for (const GridGroup& group : grid->groups) {
      if (std::ranges::find(names, group.name) == names.end()) names.push_back(group.name);
    }
  }
  return names;
}

void mix_groups(ViewSession& session) {
  const std::vector<std::string> names = group_names(session);
  for (const auto& factor : session.factors) {
    if (std::ranges::find(names, factor.first) == names.end()) {
      throw ParameterError(
          "groups", fmt::format("no grid has a group '{}'; there {} {}", factor.first, names.size() == 1 ? "is" : "are",
                                names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
    }
  }
  for (ViewLamp& lamp : session.lamps) lamp.of_group = Rgb(1, 1, 1);
  bool dimmed = false;
  for (const auto& asset : session.assets) {
    const IrradianceGrid* grid = grouped_grid(*asset);
    if (grid == nullptr) continue;
    GroupFactors own;
    for (const GridGroup& group : grid->groups) {
      if (const auto found = session.factors.find(group.name); found != session.factors.end()) own.insert(*found);
    }
    mix_asset(*asset, own);
    const std::vector<std::string> of_lamp = words_of(grid->metadata, lamp_groups_key);
    if (dimmed || of_lamp.size() != session.lamps.size()) continue;
    for (std::size_t i = 0; i < of_lamp.size(); ++i) {
      if (const auto found = own.find(of_lamp[i]); found != own.end()) session.lamps[i].of_group = found->second;
    }
    dimmed = true;
  }
  shine(session);
}

}  // namespace ivory
