// Light of spherical lights by products of cosine lobes: reflectance as lobes, and what it sends on of the light past
// the spheres that stand before it.
#pragma once

#include <array>
#include <cstddef>

#include "grid/lobes/table.h"
#include "grid/lobes/visibility.h"

namespace ivory {

inline constexpr std::size_t max_glossy_lobes = 7;

// The reflectance at a surface towards one direction wo, as a function of wi:
// f = diffuse + sum_i color_i max(axis_i.wi, 0)^exponent_i, in 1/sr, above the horizon of ns.
struct LobeReflectance {
  struct Glossy {
    V3f axis;
    float exponent = 0;
    Rgb color{0, 0, 0};
  };
  V3f ns;
  Rgb diffuse{0, 0, 0};
  std::array<Glossy, max_glossy_lobes> glossy;
  int glossy_count = 0;
};

// f(wi) max(ns.wi, 0) in 1/sr.
Rgb eval(const LobeReflectance& reflectance, const V3f& wi);

// The exponent of the Phong lobe as wide as a GGX lobe of roughness alpha: Blinn's lobe of half vectors has 2/alpha^2 -
// 2 (both fall by the same factor at small angles), and a reflected direction turns twice as far as its half vector,
// which is a quarter of the exponent. 0 to max_lobe_exponent.
float phong_exponent(float roughness_alpha);

// The same as a sum of lobes: color times a lobe of scale 1 at most. The diffuse one has exponent 1; each glossy lobe
// is multiplied by the cosine lobe around ns.
struct ReflectanceLobe {
  Lobe lobe;
  Rgb color{0, 0, 0};
};
struct ReflectanceLobes {
  std::array<ReflectanceLobe, max_glossy_lobes + 1> lobes;
  int count = 0;
};
ReflectanceLobes make_reflectance_lobes(const LobeTable& table, const LobeReflectance& reflectance);

struct LobeLightParams {
  int mask_depth = 4;  // cells a side of the mask: 2^depth; 0 to max_mask_depth
  MaskRule mask_rule = MaskRule::center;
  // Products estimated below this fraction of the lobe's unshadowed light are dropped. 0 keeps all.
  float threshold = 1e-3F;
  // A light that a glossy lobe is narrower than is taken as up to 4^n leaves of its own, so that reflections keep the
  // light's edge; 0 takes it as one lobe always. At most max_mask_depth.
  int max_split_level = 3;
};

// What a surface with shading normal ns at p sends on of the light of a sphere of radiance 1, in nits. A light that
// holds p or lies below the horizon gives nothing; spheres that hold p or lie behind the light cast no shadow, so that
// the light itself may be among them.
Rgb lobe_light(const LobeTable& table, const Sphere& light, const SphereGroups& occluders, const V3f& p, const V3f& ns,
               const ReflectanceLobes& reflectance, const LobeLightParams& params);

}  // namespace ivory
