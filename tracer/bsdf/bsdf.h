// The reflection model of glTF: a GGX microfacet lobe, and below it a diffuse one that gets what the other leaves.
// wo points towards where the light goes, wi towards where it comes from; both leave the surface.
#pragma once

#include <optional>

#include "tracer/bsdf/microfacet_albedo.h"
#include "tracer/core/surface.h"

namespace ivory {

struct Bsdf {
  V3f ns;  // unit shading normal, on the side of wo
  V3f ng;  // unit geometric normal, likewise
  Rgb diffuse_albedo;
  Rgb f0;                     // reflectance of the microfacet lobe at normal incidence
  Rgb f90;                    // and at grazing incidence
  float alpha = 1;            // GGX
  AlbedoPolynomial albedo{};  // of the microfacet lobe, strongest channel; 0 where there is one lobe alone
  float mean_left = 1;        // mean_left_below() of it
};

// That of a surface; very narrow lobes are widened to what float can tell apart.
Bsdf make_bsdf(const Surface& surface);

// Has it no microfacet lobe?
inline bool is_lambertian(const Bsdf& bsdf) { return is_black(bsdf.f0) && is_black(bsdf.f90); }

enum class Lobes { all, diffuse, specular };

// Which of the two directions the light comes from: wi for paths from the eye, wo for photons. The model is reciprocal
// but for shading normals that differ from the geometric one: the diffuse lobe is dimmed where light grazes the facet,
// see terminator() in bsdf.cpp.
enum class LightFrom { wi, wo };

// f(wo, wi) |ns.wi| in 1/sr, 0 where either lies below ng or ns.
Rgb eval(const Bsdf& bsdf, const V3f& wo, const V3f& wi, Lobes lobes = Lobes::all, LightFrom light = LightFrom::wi);

struct BsdfSample {
  V3f wi;
  Rgb throughput;             // f |ns.wi| / pdf
  float pdf_solid_angle = 0;  // 1/sr
};
// Samples wi roughly in proportion to eval(), by u_lobe and u uniform in [0, 1). Nothing where the sample falls below
// the surface: that energy is lost to the model, not to the sampling.
std::optional<BsdfSample> sample(const Bsdf& bsdf, const V3f& wo, float u_lobe, const V2f& u, Lobes lobes = Lobes::all,
                                 LightFrom light = LightFrom::wi);

// Density (1/sr) with which sample() chooses wi; 0 where eval() is.
float pdf(const Bsdf& bsdf, const V3f& wo, const V3f& wi, Lobes lobes = Lobes::all);

// eval() and pdf() of one pair of directions at less than the cost of both.
struct BsdfValue {
  Rgb value{0, 0, 0};  // f |ns.wi|, 1/sr
  float pdf_solid_angle = 0;
};
BsdfValue eval_with_pdf(const Bsdf& bsdf, const V3f& wo, const V3f& wi, LightFrom light = LightFrom::wi);

// Fraction of uniform diffuse incident light that the diffuse lobe sends towards wo (per channel):
// L_out = diffuse_reflectance / pi * E for light that arrives as irradiance. E is that of the shading normal, which has
// no terminator: as if ng were ns.
Rgb diffuse_reflectance(const Bsdf& bsdf, const V3f& wo);

}  // namespace ivory
