#include "tools/view/draw/colormap.h"

#include <algorithm>

namespace ivory {

// Even samples of two well-known maps, by matplotlib.cm.get_cmap(NAME)(i / 16): viridis, and coolwarm (Moreland,
// "Diverging Color Maps for Scientific Visualization", 2009).

const ColorMap& sequential_colors() {
  static const ColorMap viridis{{V3f(0.267F, 0.005F, 0.329F), V3f(0.282F, 0.095F, 0.417F), V3f(0.279F, 0.175F, 0.483F),
                                 V3f(0.259F, 0.252F, 0.525F), V3f(0.230F, 0.322F, 0.546F), V3f(0.199F, 0.388F, 0.555F),
                                 V3f(0.173F, 0.449F, 0.558F), V3f(0.149F, 0.508F, 0.557F), V3f(0.128F, 0.567F, 0.551F),
                                 V3f(0.121F, 0.626F, 0.533F), V3f(0.158F, 0.684F, 0.502F), V3f(0.246F, 0.739F, 0.452F),
                                 V3f(0.369F, 0.789F, 0.383F), V3f(0.516F, 0.831F, 0.294F), V3f(0.678F, 0.864F, 0.190F),
                                 V3f(0.846F, 0.887F, 0.100F), V3f(0.993F, 0.906F, 0.144F)}};
  return viridis;
}

const ColorMap& signed_colors() {
  static const ColorMap coolwarm{{V3f(0.230F, 0.299F, 0.754F), V3f(0.304F, 0.407F, 0.845F), V3f(0.384F, 0.510F, 0.918F),
                                  V3f(0.468F, 0.606F, 0.969F), V3f(0.554F, 0.690F, 0.996F), V3f(0.641F, 0.761F, 0.998F),
                                  V3f(0.724F, 0.815F, 0.976F), V3f(0.801F, 0.850F, 0.930F), V3f(0.867F, 0.864F, 0.863F),
                                  V3f(0.926F, 0.826F, 0.771F), V3f(0.960F, 0.767F, 0.674F), V3f(0.970F, 0.690F, 0.575F),
                                  V3f(0.957F, 0.598F, 0.477F), V3f(0.921F, 0.491F, 0.383F), V3f(0.865F, 0.371F, 0.296F),
                                  V3f(0.791F, 0.231F, 0.216F), V3f(0.706F, 0.016F, 0.150F)}};
  return coolwarm;
}

V3f color_at(const ColorMap& map, float x) {
  const float at = std::clamp(x, 0.0F, 1.0F) * float(map.size() - 1);
  const std::size_t below = std::min(std::size_t(at), map.size() - 2);
  const float share = at - float(below);
  return map[below] * (1 - share) + map[below + 1] * share;
}

}  // namespace ivory
