#include "tools/input/ambient.h"

#include <memory>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/base/placement.h"
#include "grid/env/irradiance.h"
#include "grid/io/difmap.h"
#include "grid/io/sh9.h"

namespace ivory {

namespace {

// From the world to where the asset's environment stood as it was baked.
M33f turn_back(const Metadata& asset, const SceneInput& input) {
  const double turn_deg = environment_turn_deg(input.origin) - environment_turn_deg(asset);
  return turn_about_y(-turn_deg * radians_a_degree);
}

}  // namespace

std::function<Rgb(const V3f&)> load_ambient(const std::string& path, const SceneInput& input,
                                            const CommonOptions& common) {
  if (path.empty()) {
    constexpr int size = 64;
    const EnvironmentImage image{EnvironmentLayout::latlong, *input.lit.scene->environment};
    auto map = std::make_shared<DifMap>();
    map->e = bake_irradiance(make_irradiance_tree(image), size).e;
    return [map](const V3f& n) { return irradiance(*map, n); };
  }
  if (is_sh9_name(path)) {
    const Sh9Asset asset = read_sh9(path);
    check_environment(path, asset.metadata, input, EnvironmentTurn::free);
    const M33f back = turn_back(asset.metadata, input);
    print_note(common, fmt::format("{}: E is wrong by {:.2f} % of the mean E on average", path,
                                   100 * asset.error.average_of_mean_e()));
    return [matrices = to_float(sh9_matrices(asset.sh)), back](const V3f& n) { return irradiance(matrices, n * back); };
  }
  auto map = std::make_shared<DifMap>(read_difmap(path));
  check_environment(path, map->metadata, input, EnvironmentTurn::free);
  return [map, back = turn_back(map->metadata, input)](const V3f& n) { return irradiance(*map, n * back); };
}

}  // namespace ivory
