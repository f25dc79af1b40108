#include "grid/fiv_light.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ivory {

namespace {

// What one occluder does to a receiver.
struct Shadow {
  Rgb hidden{0, 0, 0};    // lux
  V3f light{0, 0, 0};     // unit, mean direction of what is hidden, weighted by radiance
  V3f towards{0, 0, 0};   // unit, to the occluder's centre
  float disc_radius = 0;  // of its bounding sphere on the unit sphere about the receiver: the sine of the half-angle
  float coverage = 1;     // share of the disc that it fills
};

Shadow shadow_of(const FivPlacement& occluder, const V3f& p, const V3f& n, Straddling straddling) {
  const V3f q = (p - occluder.center_m) / occluder.radius_m;
  const float distance = q.length();
  Shadow shadow;
  shadow.towards = distance > 0 ? q / -distance : n;
  shadow.disc_radius = distance > 1 ? 1 / distance : 1;
  shadow.coverage = occluder.table->coverage;
  const float height = -q.dot(n);
  // Below the plane there is nothing to look up.
  if (height <= -1) return shadow;
  const FivMoments moments = lookup(*occluder.table, q);
  shadow.hidden = hidden_irradiance(*occluder.table, moments, n, height, straddling);
  V3f light;
  for (unsigned axis = 0; axis < 3; ++axis)
    light[axis] = luminance(Rgb(moments[3 * axis], moments[3 * axis + 1], moments[3 * axis + 2]));
  if (light.length() > 0) shadow.light = light.normalized();
  return shadow;
}

// Area that two discs share in a plane, their centres `distance` apart.
float lens_area(float r1, float r2, float distance) {
  if (distance >= r1 + r2) return 0;
  const float small = std::min(r1, r2);
  if (distance <= std::abs(r1 - r2)) return pi * small * small;
  const float c1 = std::clamp((distance * distance + r1 * r1 - r2 * r2) / (2 * distance * r1), -1.0F, 1.0F);
  const float c2 = std::clamp((distance * distance + r2 * r2 - r1 * r1) / (2 * distance * r2), -1.0F, 1.0F);
  const float triangles = (-distance + r1 + r2) * (distance + r1 - r2) * (distance - r1 + r2) * (distance + r1 + r2);
  return r1 * r1 * std::acos(c1) + r2 * r2 * std::acos(c2) - 0.5F * std::sqrt(std::max(0.0F, triangles));
}

float disc_area(const Shadow& shadow) { return pi * shadow.disc_radius * shadow.disc_radius; }

float common_area(const Shadow& a, const Shadow& b) {
  return lens_area(a.disc_radius, b.disc_radius, (a.towards - b.towards).length());
}

Rgb sum_of(std::span<const Shadow> shadows) {
  Rgb sum(0, 0, 0);
  for (const Shadow& shadow : shadows) sum += shadow.hidden;
  return sum;
}

// Eq. 13 and 14: of what a pair hides, the share of its discs that they have in common was counted twice.
Rgb hidden_by_discs(std::span<const Shadow> shadows) {
  Rgb hidden = sum_of(shadows);
  for (std::size_t i = 0; i < shadows.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const float share = common_area(shadows[i], shadows[j]) / (disc_area(shadows[i]) + disc_area(shadows[j]));
      hidden -= (shadows[i].hidden + shadows[j].hidden) * share;
    }
  }
  return hidden;
}

// How much of what an occluder hides comes from light that is gathered in a few places, 0 to 1: what it hides beyond
// what it would under an even sky, E cos(theta) c A / pi for a disc of area A filled to the share c.
float gathered_share(const Shadow& shadow, const V3f& n, const Rgb& unshadowed) {
  const float even =
      luminance(unshadowed) * std::max(0.0F, shadow.towards.dot(n)) * shadow.coverage * disc_area(shadow) / pi;
  return std::clamp(1 - even / luminance(shadow.hidden), 0.0F, 1.0F);
}

// The strongest first; each hides of its light what the ones before left open. Light spread over the disc A_k of
// an occluder: an earlier one with disc A_j, filled to the share c_j, has hidden c_j A_jk / A_k of it, if the two are
// laid out independently of each other. Light gathered in few places is hidden by both where the mean directions of the
// light that they hide agree, to within the smaller disc.
Rgb hidden_by_covers(std::span<Shadow> shadows, const V3f& n, const Rgb& unshadowed) {
  std::sort(shadows.begin(), shadows.end(),
            [](const Shadow& a, const Shadow& b) { return luminance(a.hidden) > luminance(b.hidden); });
  Rgb hidden(0, 0, 0);
  for (std::size_t k = 0; k < shadows.size(); ++k) {
    float open = 1;
    const float gathered_k = gathered_share(shadows[k], n, unshadowed);
    for (std::size_t j = 0; j < k; ++j) {
      const float gathered = gathered_k * gathered_share(shadows[j], n, unshadowed);
      const float spread = shadows[j].coverage * common_area(shadows[j], shadows[k]) / disc_area(shadows[k]);
      const float apart = (shadows[j].light - shadows[k].light).length();
      const float same = std::max(0.0F, 1 - apart / std::min(shadows[j].disc_radius, shadows[k].disc_radius));
      open *= 1 - std::min(1.0F, (1 - gathered) * spread + gathered * same);
    }
    hidden += shadows[k].hidden * open;
  }
  return hidden;
}

Rgb hidden_by_product(std::span<const Shadow> shadows, const Rgb& unshadowed) {
  Rgb visible(1, 1, 1);
  for (const Shadow& shadow : shadows) {
    for (unsigned c = 0; c < 3; ++c) {
      if (unshadowed[c] > 0) visible[c] *= std::max(0.0F, 1 - shadow.hidden[c] / unshadowed[c]);
    }
  }
  return unshadowed * (Rgb(1, 1, 1) - visible);
}

}  // namespace

Rgb fiv_irradiance(std::span<const FivPlacement> occluders, const V3f& p, const V3f& n, int self, const Rgb& unshadowed,
                   const FivLightParams& params) {
  std::vector<Shadow> shadows;
  shadows.reserve(occluders.size());
  for (std::size_t i = 0; i < occluders.size(); ++i) {
    if (int(i) == self) continue;
    const Shadow shadow = shadow_of(occluders[i], p, n, params.straddling);
    if (luminance(shadow.hidden) > 0) shadows.push_back(shadow);
  }
  Rgb hidden(0, 0, 0);
  switch (params.overlap) {
    case FivOverlap::none:
      hidden = sum_of(shadows);
      break;
    case FivOverlap::discs:
      hidden = hidden_by_discs(shadows);
      break;
    case FivOverlap::covers:
      hidden = hidden_by_covers(shadows, n, unshadowed);
      break;
    case FivOverlap::product:
      hidden = hidden_by_product(shadows, unshadowed);
      break;
  }
  Rgb open = unshadowed;
  if (self >= 0) {
    const FivPlacement& own = occluders[std::size_t(self)];
    const FivMoments moments = lookup(*own.table, (p - own.center_m) / own.radius_m);
    open = self_shadowed_irradiance(*own.table, moments, n);
  }
  Rgb e;
  for (unsigned c = 0; c < 3; ++c) {
    // The others darken what the receiver's own object leaves in the proportion in which they darken all light.
    const float share = unshadowed[c] > 0 ? std::clamp(hidden[c] / unshadowed[c], 0.0F, 1.0F) : 0.0F;
    e[c] = std::min(open[c], unshadowed[c]) * (1 - share);
  }
  return e;
}

}  // namespace ivory
