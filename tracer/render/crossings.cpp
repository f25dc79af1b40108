#include "tracer/render/crossings.h"

#include <algorithm>

namespace ivory {

Crossings cross_surfaces(const LitScene& lit, const Ray& ray) {
  Crossings crossings;
  const auto add = [&](const Hit& hit, float coverage) {
    crossings.seen[crossings.count++] = {hit, crossings.beyond * coverage};
    crossings.beyond *= 1 - coverage;
  };
  if (!lit.intersector.has_coverage()) {
    if (const std::optional<Hit> hit = lit.intersector.closest(ray)) add(*hit, 1);
    return crossings;
  }
  const Passage passage = lit.intersector.pass(ray);
  for (std::size_t i = 0; i < passage.count; ++i) {
    add(passage.crossed[i].hit, passage.crossed[i].coverage);
    if (!(crossings.beyond > 0)) return crossings;
  }
  if (passage.end) add(*passage.end, 1);
  return crossings;
}

namespace {

float reflectance_estimate(const Surface& surface) {
  // Some reflect at grazing incidence alone: about a twentieth of the light from all sides.
  return max_component(surface.diffuse_albedo) + max_component(surface.specular_f0) +
         0.05F * max_component(surface.specular_f90);
}

}  // namespace

std::array<float, Passage::most + 1> going_on(const SeenSurfaces& seen) {
  std::array<float, Passage::most + 1> probabilities{};
  float total = 0;
  for (std::size_t i = 0; i < seen.count; ++i) {
    probabilities[i] = seen.weights[i] * reflectance_estimate(seen.surfaces[i]);
    total += probabilities[i];
  }
  if (!(total > 0)) return {};
  for (std::size_t i = 0; i < seen.count; ++i) probabilities[i] /= total;
  return probabilities;
}

std::size_t choose(std::span<const float> probabilities, float u) {
  // The last that has any takes what rounding leaves over.
  std::size_t last = 0;
  for (std::size_t i = 0; i < probabilities.size(); ++i) {
    if (!(probabilities[i] > 0)) continue;
    last = i;
    if (u < probabilities[i]) break;
    u -= probabilities[i];
  }
  return last;
}

}  // namespace ivory
