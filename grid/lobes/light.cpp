#include "grid/lobes/light.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

// A light is a cap of radiance 1 times its colour, which the mask's leaves cut into caps: c_0 for the whole and c_k for
// the leaves, as lobes whose integrals are the caps' solid angles. For a lobe f of the reflectance (cosine included)
//
//   L = I  sum_{k lit} g_k / sum_k g_k,   I = int f c_0,  g_k = int f c_k,
//
// which is the report's L = I - sum_{k dark} w g_k (eq. 39) with the weight w = I/sum_k g_k: the one that makes the
// leaves of a light that is covered altogether cancel its lobe exactly, whatever f. Nothing is left to adjust. Leaves
// of f = 1 give the lit fraction of the light's solid angle, leaves of the cosine their irradiance; both exactly,
// because a leaf's lobe has the leaf's solid angle and vector moment.
//
// Where f is narrower than the light, one lobe is a poor picture of the light's edge: leaves are then kept at a least
// level and L = sum_{k lit} g_k. All leaves' solid angles still add up to the light's.

namespace ivory {

Rgb eval(const LobeReflectance& reflectance, const V3f& wi) {
  const float cosine = reflectance.ns.dot(wi);
  if (!(cosine > 0)) return Rgb(0, 0, 0);
  Rgb f = reflectance.diffuse;
  for (int i = 0; i < reflectance.glossy_count; ++i) {
    const LobeReflectance::Glossy& lobe = reflectance.glossy[std::size_t(i)];
    const float c = lobe.axis.dot(wi);
    if (c > 0) f += lobe.color * std::pow(c, lobe.exponent);
  }
  return f * cosine;
}

ReflectanceLobes make_reflectance_lobes(const LobeTable& table, const LobeReflectance& reflectance) {
  ReflectanceLobes result;
  const Lobe cosine{reflectance.ns, 1, 1};
  if (!is_black(reflectance.diffuse)) result.lobes[std::size_t(result.count++)] = {cosine, reflectance.diffuse};
  for (int i = 0; i < reflectance.glossy_count; ++i) {
    const LobeReflectance::Glossy& lobe = reflectance.glossy[std::size_t(i)];
    const Lobe product = lobe_product(table, cosine, {lobe.axis, lobe.exponent, 1});
    if (product.scale > 0) result.lobes[std::size_t(result.count++)] = {product, lobe.color};
  }
  return result;
}

float phong_exponent(float roughness_alpha) {
  const float alpha2 = std::max(roughness_alpha * roughness_alpha, 1e-12F);
  return std::clamp(0.5F * (1 - alpha2) / alpha2, 0.0F, max_lobe_exponent);
}

namespace {

// f with the lobe of a patch: its solid angle over 2 pi and 1 - mean cosine.
float product_with_patch(const LobeTable& table, const Lobe& f, const V3f& axis, float height, float spread) {
  const float cosine = f.axis.dot(axis);
  // A matt surface sees of a patch above its horizon the vector moment alone. Lobes reach farther than patches; at one
  // and a half times the patch's sine the part of it below the horizon is under 1e-4.
  if (f.exponent == 1 && cosine * cosine >= 4.5F * spread * (2 - 2 * spread) && cosine > 0)
    return f.scale * cosine * 2 * pi * height * (1 - spread);
  return lobe_product_integral(table, f, spread_lobe(axis, height, spread));
}

// The product of f with a leaf of height h is near s_f (2 pi h (2 + e_f h)/... ) cos^H(angle), H the harmonic sum of
// the two exponents: it is below `least` where the angle's cosine is below the returned value.
float cosine_of_product(const Lobe& f, float height, float least) {
  const float e = std::min(2 / height - 2, max_lobe_exponent);
  const float peak = f.scale * 2 * pi * (2 - height) / (f.exponent + e + 1);
  const float ratio = least / peak;
  if (!(ratio < 1)) return 2;  // even the peak is
  const float harmonic = f.exponent * e / std::max(f.exponent + e, 1e-6F);
  return harmonic > 1e-3F ? std::pow(ratio, 1 / harmonic) : -1.0F;
}

struct LightLeaves {
  std::array<MaskLeaf, max_mask_leaves> leaves;
  int count = 0;
};

// The level at which the light's leaves are a quarter as wide as f, or as wide as they may be.
int split_level(const Lobe& f, const LightCap& cap, const LobeLightParams& params) {
  const float light_exponent = 2 / cap.height - 2;
  int level = 0;
  for (float e = light_exponent; level < params.max_split_level && e < 16 * f.exponent; e *= 4) ++level;
  return level;
}

// Sum of products with lit leaves over the sum with all, or the former alone for a split light.
float lit_part(const LobeTable& table, const Lobe& f, const LightCap& cap, const LightLeaves& leaves, bool split,
               const LobeLightParams& params) {
  const float whole = product_with_patch(table, f, cap.z, cap.height, 0.5F * cap.height);
  if (!(whole > 0)) return 0;
  if (leaves.count == 1 && !split) return leaves.leaves[0].lit ? whole : 0;
  std::array<float, max_mask_depth + 1> least_cosine;
  if (params.threshold > 0) {
    for (int level = 0; level <= max_mask_depth; ++level) {
      // A leaf's share of the disc is that of its square in the disc's circumscribed one, near enough.
      const float height = cap.height * (4 / pi) / float(1 << (2 * level));
      least_cosine[std::size_t(level)] = cosine_of_product(f, std::min(height, cap.height), params.threshold * whole);
    }
  } else {
    least_cosine.fill(-2);
  }
  float lit = 0;
  float dark = 0;
  float lit_height = 0;
  for (int i = 0; i < leaves.count; ++i) {
    const MaskLeaf& leaf = leaves.leaves[std::size_t(i)];
    if (leaf.lit) lit_height += leaf.height;
    if (f.axis.dot(leaf.axis) < least_cosine[std::size_t(leaf.level)]) continue;
    (leaf.lit ? lit : dark) += product_with_patch(table, f, leaf.axis, leaf.height, leaf.spread);
  }
  // A threshold so high that nothing is left: by solid angle.
  if (!(lit + dark > 0)) return whole * (lit_height / cap.height);
  return split ? lit : whole * (lit / (lit + dark));
}

Rgb by_lobes(const LobeTable& table, const Sphere& light, const LightCap& cap, const V3f& p,
             const ReflectanceLobes& reflectance, std::span<const Sphere> near, const LobeLightParams& params) {
  const ShadowMask mask = make_shadow_mask(light, cap, p, near, params.mask_depth, params.mask_rule);
  LightLeaves leaves;
  int level = 0;
  for (int i = 0; i < reflectance.count; ++i)
    level = std::max(level, split_level(reflectance.lobes[std::size_t(i)].lobe, cap, params));
  leaves.count = mask_leaves(mask, cap, leaves.leaves, level);
  Rgb sum(0, 0, 0);
  for (int i = 0; i < reflectance.count; ++i) {
    const ReflectanceLobe& r = reflectance.lobes[std::size_t(i)];
    const bool split = split_level(r.lobe, cap, params) > 0;
    sum += r.color * lit_part(table, r.lobe, cap, leaves, split, params);
  }
  return sum;
}

}  // namespace

Rgb lobe_light(const LobeTable& table, const Sphere& light, const SphereGroups& occluders, const V3f& p, const V3f& ns,
               const ReflectanceLobes& reflectance, const LobeLightParams& params) {
  if (!(power(light, p) > 0)) return Rgb(0, 0, 0);
  // Below the horizon altogether.
  if ((light.center - p).dot(ns) <= -light.radius_m) return Rgb(0, 0, 0);
  const LightCap cap = make_light_cap(light, p);
  thread_local std::vector<Sphere> near;
  find_hiding(occluders, make_cone(cap, p), near);
  return by_lobes(table, light, cap, p, reflectance, near, params);
}

}  // namespace ivory
