#include "tracer/bsdf/bsdf.h"

#include <algorithm>
#include <cmath>

#include "tracer/core/sampling.h"

// Materials are glTF 2.0's with KHR_materials_specular:
//
//   f = albedo/pi d(wo) d(wi) / mean(d) + F(h.wo) D(h) V(wo, wi),   F(u) = f0 + (f90 - f0) (1 - u)^5
//
// with h the half vector, D the GGX distribution and V = G2/(4 cos cos) with Smith's height-correlated G2. The
// specification's appendix B gives the diffuse lobe 1 - F(h.wo) instead of d, and leaves it open to conserve energy
// better: so mixed, a white dielectric reflects up to 1.56 of what arrives at grazing angles and 1.04 of diffuse light.
// Here d(w) = 1 - E(w), what the microfacet lobe leaves of light from w (Kelemen & Szirmay-Kalos 2001, "A Microfacet
// Based Coupled Specular-Matte BRDF Model", eq. 4). The diffuse lobe then reflects albedo d(wo) of light that comes
// from everywhere, and both together E + albedo (1 - E) <= 1, in any direction; and the model stays reciprocal. E is
// bounded from above (microfacet_albedo.h), of the strongest channel, so that hues stay as they are. What light the
// microfacet lobe loses to masking is left lost, as in the specification: a white metal of roughness 1 reflects 0.41 of
// diffuse light, of 0.5 0.88.
//
// Everything below works in the frame whose z is the shading normal: the sine of a half vector near
// the pole then comes from its x and y, where 1 - z^2 would lose all digits for small alpha.

namespace ivory {

namespace {

// Smaller lobes are narrower than the rounding of the unit vectors that they are measured with:
// at 1e-3 an error of 6e-8 in h changes D by 1e-4 at most.
constexpr float min_alpha = 1e-3F;

float pow5(float x) {
  const float x2 = x * x;
  return x2 * x2 * x;
}

Rgb fresnel(const Bsdf& bsdf, float cosine) {
  return bsdf.f0 + (bsdf.f90 - bsdf.f0) * pow5(1.0F - std::clamp(cosine, 0.0F, 1.0F));
}

// D(h) = 1 / (pi alpha^2 (cos^2 + sin^2/alpha^2)^2).
float ggx(float alpha, const V3f& h) {
  const float s = (h.x * h.x + h.y * h.y) / (alpha * alpha);
  const float d = h.z * h.z + s;
  return 1.0F / (pi * alpha * alpha * d * d);
}

// Smith's Lambda for GGX (Heitz 2014, eq. 72).
float smith_lambda(float alpha, const V3f& w) {
  const float tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
  return 0.5F * (std::sqrt(1.0F + alpha * alpha * tan2) - 1.0F);
}

// Visible normals of GGX: Dupuy & Benyoub, "Sampling Visible GGX Normals with Spherical Caps", 2023.
V3f sample_visible_normal(float alpha, const V3f& wo, const V2f& u) {
  const V3f standard = V3f(wo.x * alpha, wo.y * alpha, wo.z).normalized();
  const float z = (1.0F - u.x) * (1.0F + standard.z) - standard.z;
  const V3f cap = direction_at_cosine(z, u.y);
  const V3f half = cap + standard;
  // half is 0 only for a cap direction opposite to wo, a set of measure zero that floats can hit.
  const V3f h(half.x * alpha, half.y * alpha, std::max(half.z, 0.0F));
  const float length = h.length();
  return length > 0 ? h / length : V3f(0, 0, 1);
}

// How often the specular lobe is chosen: its share of what diffuse light both lobes reflect towards wo. Exactly 0 and 1
// where a lobe is absent.
float specular_probability(const Bsdf& bsdf, float cosine, Lobes lobes) {
  if (lobes != Lobes::all) return lobes == Lobes::specular ? 1.0F : 0.0F;
  if (is_lambertian(bsdf)) return 0;
  if (is_black(bsdf.diffuse_albedo)) return 1;
  const Rgb f = fresnel(bsdf, cosine);
  const float left = left_below(bsdf.albedo, cosine);
  const float specular = (1.0F - left) * luminance(f) / max_component(f);
  const float diffuse = left * luminance(bsdf.diffuse_albedo);
  const float share = specular / (specular + diffuse);
  // Light may come from where the other lobe is the stronger, so no present lobe goes unsampled.
  return std::clamp(std::isfinite(share) ? share : 0.5F, 0.1F, 0.9F);
}

// Where light from w grazes the facet, the shading normal may still say that it is lit, and the horizon of ng would cut
// its light off at once: facets of coarse meshes stand out black. The diffuse lobe fades there instead (Chiang, Li &
// Burley 2019, "Taming the Shadow Terminator"): g = ng.w / (ns.w ng.ns) where that is below 1, through g + g^2 - g^3.
// It is at most 1, so that no energy is gained, and 1 where ns = ng.
float terminator(const Bsdf& bsdf, const V3f& w) {
  if (bsdf.ns == bsdf.ng) return 1;
  const float facet = w.dot(bsdf.ng);
  const float smooth = w.dot(bsdf.ns) * bsdf.ns.dot(bsdf.ng);
  if (!(facet < smooth)) return 1;
  const float g = std::max(facet, 0.0F) / smooth;
  return g * (1 + g * (1 - g));
}

// Value and pdf together: they share nearly all terms. wo.z > 0 and wi.z > 0; `dimmed` as terminator()
// says.
BsdfValue evaluate(const Bsdf& bsdf, const V3f& wo, const V3f& wi, float p_specular, Lobes lobes, float dimmed) {
  BsdfValue e;
  const V3f sum = wo + wi;
  const float length = sum.length();
  if (!(length > 0)) return e;
  const V3f h = sum / length;
  // wo.h = wi.h = |wo + wi| / 2 for unit vectors: exactly the same seen from either.
  const Rgb f = fresnel(bsdf, 0.5F * length);
  if (lobes != Lobes::specular) {
    const float cosine = wi.z / pi;
    const float left = left_below(bsdf.albedo, wo.z) * left_below(bsdf.albedo, wi.z) / bsdf.mean_left;
    e.value += bsdf.diffuse_albedo * (left * cosine * dimmed);
    e.pdf_solid_angle += (1.0F - p_specular) * cosine;
  }
  if (lobes != Lobes::diffuse && !is_lambertian(bsdf)) {
    // f cos = F D G2 / (4 wo.z); pdf = D G1(wo) / (4 wo.z), G1 = 1/(1+L_o), G2 = 1/(1+L_o+L_i).
    const float d = ggx(bsdf.alpha, h) / (4.0F * wo.z);
    const float lambda_o = smith_lambda(bsdf.alpha, wo);
    const float lambda_i = smith_lambda(bsdf.alpha, wi);
    e.value += f * (d / (1.0F + lambda_o + lambda_i));
    e.pdf_solid_angle += p_specular * (d / (1.0F + lambda_o));
  }
  return e;
}

// Grazing directions closer to the surface than this are treated as below it: 1/z^2 in Lambda
// would overflow, and no light worth counting leaves there.
constexpr float min_cosine = 1e-6F;

bool above(const Bsdf& bsdf, const V3f& w, const V3f& local) { return local.z > min_cosine && w.dot(bsdf.ng) > 0; }

}  // namespace

Bsdf make_bsdf(const Surface& surface) {
  Bsdf bsdf{surface.ns,          surface.ng,           surface.diffuse_albedo,
            surface.specular_f0, surface.specular_f90, std::clamp(surface.roughness_alpha, min_alpha, 1.0F)};
  // Metals and Lambert surfaces have one lobe.
  if (is_lambertian(bsdf) || is_black(bsdf.diffuse_albedo)) return bsdf;
  bsdf.albedo = make_albedo_polynomial(max_component(bsdf.f0), max_component(bsdf.f90), bsdf.alpha);
  // Next to nothing is left below a white mirror; rounding decides how much.
  bsdf.mean_left = std::max(mean_left_below(bsdf.albedo), 1e-3F);
  return bsdf;
}

Rgb eval(const Bsdf& bsdf, const V3f& wo, const V3f& wi, Lobes lobes, LightFrom light) {
  const ShadingFrame frame = make_shading_frame(bsdf.ns);
  const V3f o = frame.to_local(wo);
  const V3f i = frame.to_local(wi);
  if (!above(bsdf, wo, o) || !above(bsdf, wi, i)) return Rgb(0, 0, 0);
  return evaluate(bsdf, o, i, 0, lobes, terminator(bsdf, light == LightFrom::wi ? wi : wo)).value;
}

float pdf(const Bsdf& bsdf, const V3f& wo, const V3f& wi, Lobes lobes) {
  const ShadingFrame frame = make_shading_frame(bsdf.ns);
  const V3f o = frame.to_local(wo);
  const V3f i = frame.to_local(wi);
  if (!above(bsdf, wo, o) || !above(bsdf, wi, i)) return 0;
  return evaluate(bsdf, o, i, specular_probability(bsdf, o.z, lobes), lobes, 1).pdf_solid_angle;
}

BsdfValue eval_with_pdf(const Bsdf& bsdf, const V3f& wo, const V3f& wi, LightFrom light) {
  const ShadingFrame frame = make_shading_frame(bsdf.ns);
  const V3f o = frame.to_local(wo);
  const V3f i = frame.to_local(wi);
  if (!above(bsdf, wo, o) || !above(bsdf, wi, i)) return {};
  return evaluate(bsdf, o, i, specular_probability(bsdf, o.z, Lobes::all), Lobes::all,
                  terminator(bsdf, light == LightFrom::wi ? wi : wo));
}

std::optional<BsdfSample> sample(const Bsdf& bsdf, const V3f& wo, float u_lobe, const V2f& u, Lobes lobes,
                                 LightFrom light) {
  const ShadingFrame frame = make_shading_frame(bsdf.ns);
  if (is_lambertian(bsdf)) {
    // Lambert alone: f cos / pdf is the albedo to the last bit, which closed-form truths rely on.
    if (!(wo.dot(bsdf.ns) > min_cosine) || !(wo.dot(bsdf.ng) > 0)) return std::nullopt;
    const V3f i = sample_cosine_hemisphere(u);
    const V3f wi = frame.to_world(i).normalized();
    if (!above(bsdf, wi, i)) return std::nullopt;
    const float dimmed = terminator(bsdf, light == LightFrom::wi ? wi : wo);
    return BsdfSample{wi, lobes == Lobes::specular ? Rgb(0, 0, 0) : bsdf.diffuse_albedo * dimmed, i.z / pi};
  }
  const V3f o = frame.to_local(wo);
  if (!above(bsdf, wo, o)) return std::nullopt;
  const float p_specular = specular_probability(bsdf, o.z, lobes);

  V3f i;
  if (u_lobe < p_specular) {
    const V3f h = sample_visible_normal(bsdf.alpha, o, u);
    i = h * (2.0F * o.dot(h)) - o;
  } else {
    i = sample_cosine_hemisphere(u);
  }
  const V3f wi = frame.to_world(i).normalized();
  if (!above(bsdf, wi, i)) return std::nullopt;

  BsdfSample s;
  s.wi = wi;
  const BsdfValue e = evaluate(bsdf, o, i, p_specular, lobes, terminator(bsdf, light == LightFrom::wi ? wi : wo));
  if (!(e.pdf_solid_angle > 0)) return std::nullopt;
  s.throughput = e.value / e.pdf_solid_angle;
  s.pdf_solid_angle = e.pdf_solid_angle;
  return s;
}

Rgb diffuse_reflectance(const Bsdf& bsdf, const V3f& wo) {
  const float mu = bsdf.ns.dot(wo);
  if (!(mu > min_cosine) || !(wo.dot(bsdf.ng) > 0)) return Rgb(0, 0, 0);
  if (is_lambertian(bsdf)) return bsdf.diffuse_albedo;
  return bsdf.diffuse_albedo * left_below(bsdf.albedo, std::min(mu, 1.0F));
}

}  // namespace ivory
