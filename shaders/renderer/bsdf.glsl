// glTF's reflection model: a Lambert lobe below a GGX microfacet lobe, mixed by Fresnel; twin of tracer/bsdf/bsdf.cpp,
// where the model is derived. wo and wi leave the surface, towards the eye and towards the light; all vectors are unit.
#include "base/pi.glsl"

struct IvorySurface {
  vec3 p;               // world, m
  vec3 ng;              // geometric normal, on the eye's side
  vec3 ns;              // shading normal, dot(ns, ng) > 0
  vec3 wo;
  vec3 diffuse_albedo;  // before Fresnel's share
  vec3 f0;              // reflectance of the microfacet lobe at normal incidence
  vec3 f90;             // and at grazing incidence; 0 for a Lambert surface
  float alpha;          // GGX, perceptual roughness squared, at least 1e-3
  vec3 emission;        // nits
  float coverage;       // 0 to 1
};


float ivory_max_component(vec3 c) { return max(c.x, max(c.y, c.z)); }

vec3 ivory_fresnel(IvorySurface s, float cosine) {
  float x = 1.0 - clamp(cosine, 0.0, 1.0);
  float x2 = x * x;
  return s.f0 + (s.f90 - s.f0) * (x2 * x2 * x);
}

float ivory_smith_lambda(float alpha, float cosine) {
  float tan2 = (1.0 - cosine * cosine) / (cosine * cosine);
  return 0.5 * (sqrt(1.0 + alpha * alpha * max(tan2, 0.0)) - 1.0);
}

// f(wo, wi) dot(ns, wi) in 1/sr; 0 where either lies below ng or ns.
vec3 ivory_eval_bsdf(IvorySurface s, vec3 wi) {
  float cos_o = dot(s.ns, s.wo);
  float cos_i = dot(s.ns, wi);
  if (cos_o <= 1e-6 || cos_i <= 1e-6 || dot(s.ng, s.wo) <= 0.0 || dot(s.ng, wi) <= 0.0) return vec3(0.0);
  vec3 sum = s.wo + wi;
  float len = length(sum);
  vec3 f = ivory_fresnel(s, 0.5 * len);
  vec3 value = s.diffuse_albedo * (max(0.0, 1.0 - ivory_max_component(f)) * cos_i / ivory_pi);
  if (ivory_max_component(s.f0) > 0.0 || ivory_max_component(s.f90) > 0.0) {
    vec3 h = sum / len;
    float cos_h = dot(s.ns, h);
    // The sine by a cross product: 1 - cos^2 has no digits left near the pole.
    vec3 across = cross(s.ns, h);
    float a2 = s.alpha * s.alpha;
    float d = cos_h * cos_h + dot(across, across) / a2;
    float ggx = 1.0 / (ivory_pi * a2 * d * d);
    value +=
        f * (ggx / (4.0 * cos_o * (1.0 + ivory_smith_lambda(s.alpha, cos_o) + ivory_smith_lambda(s.alpha, cos_i))));
  }
  return value;
}

// What of E comes back as diffuse light: L = ivory_diffuse_reflectance / pi * E. Fresnel's share of uniform light for
// f0 = 0, f90 = 1 is a polynomial in 1 - cos fitted by least squares to the integral of (1 - h.wo)^5 cos/pi over wi
// (what tracer/bsdf/bsdf.cpp tabulates), at 201 even cosines; it is within 1.1e-5.
vec3 ivory_diffuse_reflectance(IvorySurface s) {
  float mu = dot(s.ns, s.wo);
  if (mu <= 1e-6 || dot(s.ng, s.wo) <= 0.0) return vec3(0.0);
  if (ivory_max_component(s.f0) <= 0.0 && ivory_max_component(s.f90) <= 0.0) return s.diffuse_albedo;
  float x = 1.0 - min(mu, 1.0);
  float loss =
      8.294577894e-5 + x * (2.005623791e-3 + x * (9.386896016e-3 + x * (7.659487232e-3 + x * 9.030626993e-3)));
  vec3 f = s.f0 * (1.0 - loss) + s.f90 * loss;
  return s.diffuse_albedo * max(0.0, 1.0 - ivory_max_component(f));
}
