#include "tracer/lobe_direct.h"

#include <algorithm>
#include <cmath>

#include "tracer/sampling.h"

// A light is a cap of radiance 1 times its colour, which the mask's leaves cut into caps: c_0 for the whole and c_k
// for the leaves, as lobes whose integrals are the caps' solid angles. For a lobe f of the reflectance (cosine
// included)
//
//   L = I  sum_{k lit} g_k / sum_k g_k,   I = int f c_0,  g_k = int f c_k,
//
// which is the report's L = I - sum_{k dark} w g_k (eq. 39) with the weight w = I/sum_k g_k: the one that makes the
// leaves of a light that is covered altogether cancel its lobe exactly, whatever f. Nothing is left to adjust.
// Leaves of f = 1 give the lit fraction of the light's solid angle, leaves of the cosine their irradiance; both
// exactly, because a leaf's lobe has the leaf's solid angle and vector moment.
//
// Where f is narrower than the light, one lobe is a poor picture of the light's edge: leaves are then kept at a least
// level and L = sum_{k lit} g_k. All leaves' solid angles still add up to the light's.

namespace ivory {

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
int split_level(const Lobe& f, const LightCap& cap, const LobeParams& params) {
  const float light_exponent = 2 / cap.height - 2;
  int level = 0;
  for (float e = light_exponent; level < params.max_split_level && e < 16 * f.exponent; e *= 4) ++level;
  return level;
}

// Sum of products with lit leaves over the sum with all, or the former alone for a split light.
float lit_part(const LobeScene& lobes, const Lobe& f, const LightCap& cap, const LightLeaves& leaves, bool split,
               const LobeParams& params) {
  const float whole = product_with_patch(lobes.table, f, cap.z, cap.height, 0.5F * cap.height);
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
    (leaf.lit ? lit : dark) += product_with_patch(lobes.table, f, leaf.axis, leaf.height, leaf.spread);
  }
  // A threshold so high that nothing is left: by solid angle.
  if (!(lit + dark > 0)) return whole * (lit_height / cap.height);
  return split ? lit : whole * (lit / (lit + dark));
}

Rgb by_lobes(const LobeScene& lobes, const Sphere& light, const LightCap& cap, const V3f& p,
             const ReflectanceLobes& reflectance, std::span<const Sphere> near, const LobeParams& params) {
  ShadowMask mask;
  mask.depth = params.mask_depth;
  if (params.shadows == LobeShadows::lobes)
    mask = make_shadow_mask(light, cap, p, near, params.mask_depth, params.mask_rule);
  LightLeaves leaves;
  int level = 0;
  for (int i = 0; i < reflectance.count; ++i)
    level = std::max(level, split_level(reflectance.lobes[std::size_t(i)].lobe, cap, params));
  leaves.count = mask_leaves(mask, cap, leaves.leaves, level);
  Rgb sum(0, 0, 0);
  for (int i = 0; i < reflectance.count; ++i) {
    const ReflectanceLobe& r = reflectance.lobes[std::size_t(i)];
    const bool split = split_level(r.lobe, cap, params) > 0;
    sum += r.color * lit_part(lobes, r.lobe, cap, leaves, split, params);
  }
  return sum;
}

// Monte Carlo: directions uniform over the cap, one in each of rows x columns strata,
//   L = solid angle / n  sum f(w) cos V(w).
Rgb by_rays(const Intersector& intersector, const Sphere& light, const LightCap& cap, const V3f& p, const V3f& ng,
            const LobeReflectance& reflectance, std::span<const Sphere> near, const LobeParams& params,
            RandomStream& random) {
  const float light_power = power(light, p);
  // As square as the count allows; a prime is a row.
  int rows = int(std::sqrt(float(params.shadow_rays)));
  while (params.shadow_rays % rows != 0) --rows;
  const int columns = params.shadow_rays / rows;
  Rgb sum(0, 0, 0);
  for (int i = 0; i < params.shadow_rays; ++i) {
    const V2f u = random.next2();
    // Concentric map (Shirley & Chiu 1997): strata of the square stay compact on the disc, areas in proportion.
    const float a = 2 * (float(i % columns) + u.x) / float(columns) - 1;
    const float b = 2 * (float(i / columns) + u.y) / float(rows) - 1;
    const bool wide = std::abs(a) > std::abs(b);
    const float r = wide ? a : b;
    const float other = wide ? b : a;
    const float turn = r != 0 ? 0.25F * pi * other / r : 0.0F;
    const float x = r * (wide ? std::cos(turn) : std::sin(turn));
    const float y = r * (wide ? std::sin(turn) : std::cos(turn));
    // Lambert's equal-area map of the disc to the cap.
    const float versine = (x * x + y * y) * cap.height;
    const float stretch = std::sqrt(cap.height * (2 - versine));
    const V3f w = (cap.x * (x * stretch) + cap.y * (y * stretch) + cap.z * (1 - versine)).normalized();
    const Rgb f = eval(reflectance, w);
    const bool below = ng.dot(w) <= 0;  // of the surface itself, where shading normals say otherwise
    if (is_black(f) || (below && params.shadows == LobeShadows::mesh)) continue;
    float visible = 1;
    if (params.shadows == LobeShadows::spheres) {
      const auto hides = [&](const Sphere& sphere) { return power(sphere, p) < light_power && meets(sphere, p, w); };
      if (std::any_of(near.begin(), near.end(), hides)) visible = 0;
    } else {
      Ray ray;
      ray.origin = offset_origin(p, ng, w);
      ray.direction = w;
      // To the ball, short of it by more than its mesh stands out of it.
      const V3f d = light.center - ray.origin;
      const float along = d.dot(w);
      const float inside2 = light.radius_m * light.radius_m - (d - w * along).length2();
      ray.t_max = along - std::sqrt(std::max(inside2, 0.0F)) - 2e-3F * light.radius_m;
      if (intersector.has_coverage()) ray.coverage_seed = random.next_u32();
      if (ray.t_max > 0) visible = intersector.transmittance(ray);
    }
    sum += f * visible;
  }
  return sum * (solid_angle(cap) / float(params.shadow_rays));
}

}  // namespace

Rgb lobe_direct_light(const LobeScene& lobes, const Intersector& intersector, const V3f& p, const V3f& ng,
                      const LobeReflectance& reflectance, const LobeParams& params, RandomStream& random) {
  const bool by_products = params.shadows == LobeShadows::lobes || params.shadows == LobeShadows::none;
  ReflectanceLobes reflectance_lobes;
  if (by_products) reflectance_lobes = make_reflectance_lobes(lobes.table, reflectance);
  thread_local std::vector<Sphere> near;
  Rgb sum(0, 0, 0);
  for (const SphereLight& source : lobes.lights) {
    const Sphere light{source.center, source.radius_m};
    if (!(power(light, p) > 0)) continue;
    // Below the horizon altogether.
    if ((light.center - p).dot(reflectance.ns) <= -light.radius_m) continue;
    const LightCap cap = make_light_cap(light, p);
    near.clear();
    if (params.shadows == LobeShadows::lobes || params.shadows == LobeShadows::spheres) {
      const float sine = std::sqrt(cap.height * (2 - cap.height));
      find_hiding(lobes.occluders, {p, cap.z, 1 - cap.height, sine}, near);
    }
    const Rgb reflected = by_products ? by_lobes(lobes, light, cap, p, reflectance_lobes, near, params)
                                      : by_rays(intersector, light, cap, p, ng, reflectance, near, params, random);
    sum += source.radiance_nits * reflected;
  }
  return sum;
}

Film render_lobes(const LobeScene& lobes, const Intersector& intersector, const View& view, const RenderParams& render,
                  const LobeParams& params) {
  const Scene& scene = intersector.scene();
  return render_film(view, render, [&](const Ray& ray, RandomStream& random) {
    const std::optional<Hit> hit = intersector.closest(ray);
    if (!hit) return Rgb(0, 0, 0);
    const Surface surface = make_surface(scene, ray, *hit);
    const V3f wo = -ray.direction;
    const LobeReflectance reflectance = make_lobe_reflectance(scene, *hit, surface, wo);
    return surface.emission + lobe_direct_light(lobes, intersector, surface.p, surface.ng, reflectance, params, random);
  });
}

}  // namespace ivory
