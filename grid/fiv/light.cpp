#include "grid/fiv/light.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ivory {

namespace {

FivMoments hidden_from(const FivPlacement& occluder, const V3f& q) {
  FivMoments moments = lookup(*occluder.table, q);
  if (occluder.next == nullptr) return moments;
  const FivMoments next = lookup(*occluder.next, q);
  for (std::size_t i = 0; i < moments.size(); ++i) moments[i] += (next[i] - moments[i]) * occluder.next_share;
  return moments;
}

// What one occluder does to a receiver.
struct Shadow {
  Rgb hidden{0, 0, 0};    // lux
  V3f light{0, 0, 0};     // unit, mean direction of what is hidden, weighted by radiance
  V3f towards{0, 0, 0};   // unit, to the occluder's centre
  float disc_radius = 1;  // of its bounding sphere on the unit sphere about the receiver: the sine of the half-angle
  Rgb coverage{0, 0, 0};  // share of the light of its disc that it hides, see covered_share()
  float gathered = 0;     // share of what it hides that comes from light gathered in a few places
};

float disc_area(const Shadow& shadow) { return pi * shadow.disc_radius * shadow.disc_radius; }

// What an occluder hides beyond what it would under an even sky, E cos(theta) c A / pi for a disc of area A filled to
// the share c.
float gathered_share(const Shadow& shadow, const V3f& n, const Rgb& unshadowed, float filled) {
  const float even = luminance(unshadowed) * std::max(0.0F, shadow.towards.dot(n)) * filled * disc_area(shadow) / pi;
  return std::clamp(1 - even / luminance(shadow.hidden), 0.0F, 1.0F);
}

// The share of its disc that an occluder fills is a mean over all sides and distances, far ones above all. Near by, it
// hides more: what it hides over what comes through the disc from an even sky, where that is the larger. Of a disc of
// radius r at angle theta this is E r^2 cos(theta) far off, and E (1 + cos(theta)) / 2 of a half space; between the two
// by r. Taken for the mean alone, two shadows that meet at a contact sum to more than all light, first of the colours
// that both hide most, and leave the rest of the sky's: deep blue.
Rgb covered_share(const Shadow& shadow, const V3f& n, const Rgb& unshadowed, float filled) {
  const float cosine = std::max(0.0F, shadow.towards.dot(n));
  const float r = shadow.disc_radius;
  const float disc = r * r * (cosine + 0.5F * r * (1 - cosine));
  Rgb share;
  for (unsigned c = 0; c < 3; ++c) {
    const float through = unshadowed[c] * disc;
    share[c] = through > 0 ? std::max(filled, std::min(1.0F, shadow.hidden[c] / through)) : filled;
  }
  return share;
}

// For a receiver at q (in bounding radii) over whose plane the centre stands `height` high, above -1. `hidden` may be
// black; then the rest is of no account.
Shadow shadow_of(const FivPlacement& occluder, const V3f& q, float height, const V3f& n, Straddling straddling,
                 const Rgb& unshadowed) {
  const float distance = q.length();
  Shadow shadow;
  shadow.towards = distance > 0 ? q / -distance : n;
  shadow.disc_radius = distance > 1 ? 1 / distance : 1;
  const FivMoments moments = hidden_from(occluder, q);
  shadow.hidden = hidden_irradiance(*occluder.table, moments, n, height, straddling);
  if (!(luminance(shadow.hidden) > 0)) return shadow;
  V3f light;
  for (unsigned axis = 0; axis < 3; ++axis)
    light[axis] = luminance(Rgb(moments[3 * axis], moments[3 * axis + 1], moments[3 * axis + 2]));
  if (light.length() > 0) shadow.light = light.normalized();
  shadow.gathered = gathered_share(shadow, n, unshadowed, occluder.table->coverage);
  shadow.coverage = covered_share(shadow, n, unshadowed, occluder.table->coverage);
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

float common_area(const Shadow& a, const Shadow& b) {
  return lens_area(a.disc_radius, b.disc_radius, (a.towards - b.towards).length());
}

// How much of what `weak` hides `strong` has left open. Light spread over the weak one's disc A_k: the strong one with
// disc A_j, filled to the share c_j, has hidden c_j A_jk / A_k of it, if the two are laid out independently of each
// other. Light gathered in few places is hidden by both where the mean directions of the light that they hide agree, to
// within the smaller disc.
Rgb left_open(const Shadow& strong, const Shadow& weak) {
  const float gathered = weak.gathered * strong.gathered;
  const float common = common_area(strong, weak) / disc_area(weak);
  const float apart = (strong.light - weak.light).length();
  const float same = std::max(0.0F, 1 - apart / std::min(strong.disc_radius, weak.disc_radius));
  Rgb open;
  for (unsigned c = 0; c < 3; ++c)
    open[c] = 1 - std::min(1.0F, (1 - gathered) * strong.coverage[c] * common + gathered * same);
  return open;
}

// Shadows as they come, one at a time: what the overlap rules keep of them.
struct Shadows {
  std::array<Shadow, fiv_strongest> strongest;  // in descending order of luminance hidden, `count` of them
  int count = 0;
  Rgb sum{0, 0, 0};            // of all
  Rgb share_of_all{1, 1, 1};   // of the unshadowed light that is visible if shadows multiply: of all,
  Rgb share_of_rest{1, 1, 1};  // and of all but the strongest, after what those hide already
};

void multiply_visible(Rgb& share, const Rgb& hidden, const Rgb& unshadowed) {
  for (unsigned c = 0; c < 3; ++c) {
    if (unshadowed[c] > 0) share[c] *= std::max(0.0F, 1 - hidden[c] / unshadowed[c]);
  }
}

void add(Shadows& shadows, Shadow shadow, const Rgb& unshadowed) {
  shadows.sum += shadow.hidden;
  multiply_visible(shadows.share_of_all, shadow.hidden, unshadowed);
  for (int i = 0; i < shadows.count; ++i) {
    Shadow& kept = shadows.strongest[std::size_t(i)];
    if (luminance(shadow.hidden) > luminance(kept.hidden)) std::swap(shadow, kept);
  }
  if (shadows.count < fiv_strongest) {
    shadows.strongest[std::size_t(shadows.count++)] = shadow;
    return;
  }
  Rgb open(1, 1, 1);
  for (const Shadow& strong : shadows.strongest) open *= left_open(strong, shadow);
  multiply_visible(shadows.share_of_rest, shadow.hidden * open, unshadowed);
}

// Eq. 13 and 14: of what a pair hides, the share of its discs that they have in common was counted twice.
Rgb hidden_by_discs(const Shadows& shadows) {
  Rgb hidden = shadows.sum;
  for (std::size_t i = 0; i < std::size_t(shadows.count); ++i) {
    const Shadow& a = shadows.strongest[i];
    for (std::size_t j = 0; j < i; ++j) {
      const Shadow& b = shadows.strongest[j];
      hidden -= (a.hidden + b.hidden) * (common_area(a, b) / (disc_area(a) + disc_area(b)));
    }
  }
  return hidden;
}

// The most of what is left that a shadow takes where discs say that none of it was hidden before: half way between its
// share of all light, as if laid out independently, and everything. Without a limit some colour comes to nothing, the
// one that all of them hide most, where truth has a little of every colour.
constexpr float most_of_rest = 0.5F;

// The strongest first; each hides of its light what the ones before left open. All others, weak as they are, hide their
// share of what is open after that.
Rgb hidden_by_covers(const Shadows& shadows, const Rgb& unshadowed) {
  Rgb hidden(0, 0, 0);
  for (std::size_t k = 0; k < std::size_t(shadows.count); ++k) {
    Rgb open(1, 1, 1);
    for (std::size_t j = 0; j < k; ++j) open *= left_open(shadows.strongest[j], shadows.strongest[k]);
    const Rgb& own = shadows.strongest[k].hidden;
    for (unsigned c = 0; c < 3; ++c) {
      const float rest = std::max(0.0F, unshadowed[c] - hidden[c]);
      const float share = unshadowed[c] > 0 ? std::min(1.0F, own[c] / unshadowed[c]) : 0.0F;
      // The first is not compared with any.
      const float most = k == 0 ? rest : rest * (share + most_of_rest * (1 - share));
      hidden[c] += std::min(own[c] * open[c], most);
    }
  }
  for (unsigned c = 0; c < 3; ++c)
    hidden[c] += std::max(0.0F, unshadowed[c] - hidden[c]) * (1 - shadows.share_of_rest[c]);
  return hidden;
}

Rgb hidden_by(FivOverlap overlap, const Shadows& shadows, const Rgb& unshadowed) {
  switch (overlap) {
    case FivOverlap::none:
      break;
    case FivOverlap::discs:
      return hidden_by_discs(shadows);
    case FivOverlap::covers:
      return hidden_by_covers(shadows, unshadowed);
    case FivOverlap::product:
      return unshadowed * (Rgb(1, 1, 1) - shadows.share_of_all);
  }
  return shadows.sum;
}

}  // namespace

// Interpolation weights are positive, and both n.F and the lower bound of irradiance_bracket() are at most |I_+i| +
// |I_-i| for some axis i, a sum of norms and so convex: it is nowhere greater than at the samples.
float most_hidden(const FivTable& table) {
  const auto numbers = std::size_t(3 * fiv_function_count(table.hemispheres));
  const std::size_t sphere = std::size_t(table.size.x) * std::size_t(table.size.y);
  float most = 0;
  for (std::size_t i = 0; i < fiv_sample_count(table); ++i) {
    const float* m = table.values.data() + i * numbers;
    const auto norms = [m](const float* split, float sign) {
      Rgb out;
      for (std::size_t c = 0; c < 3; ++c) {
        V3f v;
        for (std::size_t axis = 0; axis < 3; ++axis)
          v[int(axis)] = (m[3 * axis + c] + (split == nullptr ? m : split)[3 * axis + c] * sign) / 2;
        out[int(c)] = v.length();
      }
      return luminance(out);
    };
    float here = norms(nullptr, 1);
    for (std::size_t axis = 1; numbers == 36 && axis < 4; ++axis)
      here = std::max(here, norms(m + 9 * axis, 1) + norms(m + 9 * axis, -1));
    most = std::max(most, here / fiv_falloff(table.radii[i / sphere]));
  }
  return most;
}

Rgb fiv_irradiance(std::span<const FivPlacement> occluders, const V3f& p, const V3f& n, int self, const Rgb& unshadowed,
                   const FivLightParams& params) {
  Shadows shadows;
  float neglected = 0;
  for (std::size_t i = 0; i < occluders.size(); ++i) {
    if (int(i) == self) continue;
    const FivPlacement& occluder = occluders[i];
    const V3f q = (p - occluder.center_m) / occluder.radius_m;
    const float height = -q.dot(n);
    // Below the plane there is nothing to look up.
    if (height <= -1) continue;
    const float at_most = occluder.most_hidden * fiv_falloff(q.length());
    if (neglected + at_most <= fiv_negligible * luminance(unshadowed)) {
      neglected += at_most;
      continue;
    }
    const Shadow shadow = shadow_of(occluder, q, height, n, params.straddling, unshadowed);
    if (luminance(shadow.hidden) > 0) add(shadows, shadow, unshadowed);
  }
  const Rgb hidden = hidden_by(params.overlap, shadows, unshadowed);
  Rgb open = unshadowed;
  if (self >= 0) {
    const FivPlacement& own = occluders[std::size_t(self)];
    const FivMoments moments = hidden_from(own, (p - own.center_m) / own.radius_m);
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
