// Reflectance made of cosine lobes: Lambert, the modified Phong model, Lafortune's.
#pragma once

#include <array>

#include "grid/lobe_table.h"
#include "tracer/surface.h"

namespace ivory {

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
  std::array<Glossy, max_lafortune_lobes> glossy;
  int glossy_count = 0;
};

// The exponent of the Phong lobe as wide as a GGX lobe of roughness alpha: Blinn's lobe of half vectors has
// 2/alpha^2 - 2 (both fall by the same factor at small angles), and a reflected direction turns twice as far as its
// half vector, which is a quarter of the exponent. 0 to max_lobe_exponent.
float phong_exponent(float roughness_alpha);

// From the material at a hit. With material.lafortune those lobes and the diffuse albedo; otherwise modified Phong,
// f = kd/pi + ks (e + 2)/(2 pi) max(r.wi, 0)^e, ks the specular reflectance at normal incidence, kd the diffuse albedo
// times what ks leaves over.
LobeReflectance make_lobe_reflectance(const Scene& scene, const Hit& hit, const Surface& surface, const V3f& wo);

// f(wi) max(ns.wi, 0) in 1/sr.
Rgb eval(const LobeReflectance& reflectance, const V3f& wi);

// The same as a sum of lobes: color times a lobe of scale 1 at most. The diffuse one has exponent 1; each glossy
// lobe is multiplied by the cosine lobe around ns.
struct ReflectanceLobe {
  Lobe lobe;
  Rgb color{0, 0, 0};
};
struct ReflectanceLobes {
  std::array<ReflectanceLobe, max_lafortune_lobes + 1> lobes;
  int count = 0;
};
ReflectanceLobes make_reflectance_lobes(const LobeTable& table, const LobeReflectance& reflectance);

}  // namespace ivory
