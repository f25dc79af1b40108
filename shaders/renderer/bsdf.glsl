// glTF's reflection model: a GGX microfacet lobe, and below it a diffuse one that gets what the
// other leaves; twin of tracer/bsdf/bsdf.cpp,
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

// A bound from above of the microfacet lobe's directional albedo, of the strongest channel, as a polynomial in 1 - mu:
// coefficients 0 to 2, and 3 to 5. Twin: tracer/bsdf/microfacet_albedo.cpp, where the numbers are explained.
struct IvoryAlbedo {
  vec3 low;
  vec3 high;
};

IvoryAlbedo ivory_microfacet_albedo(IvorySurface s) {
  float f0 = ivory_max_component(s.f0);
  float r = sqrt(s.alpha);
  float t = 1.0 / (1.0 + 8.0 * s.alpha);
  float rise = max(0.0, ivory_max_component(s.f90) - f0) * t;
  vec3 g_low = vec3(1.0007, 0.01591322, -0.09851315) +
      r * (vec3(0.0006663507, -0.7587407, 4.586061) +
      r * (vec3(-0.1685614, 9.204089, -53.26901) +
      r * (vec3(1.603242, -33.73769, 172.5005) +
      r * (vec3(-5.662997, 45.00276, -211.3273) +
      r * (vec3(3.559599, -19.60733, 88.40293))))));
  vec3 g_high = vec3(0.3153812, -0.448434, 0.2164247) +
      r * (vec3(-14.54245, 20.25374, -9.575748) +
      r * (vec3(169.4792, -231.9767, 106.9544) +
      r * (vec3(-544.6601, 710.9387, -307.1779) +
      r * (vec3(664.0224, -828.1586, 336.671) +
      r * (vec3(-276.5727, 331.3308, -127.3164))))));
  vec3 b_low = vec3(0.003264776, 0.007208752, 0.2558115) +
      t * (vec3(-0.01117413, 0.07411225, -2.521831) +
      t * (vec3(0.004610833, 0.004549425, 4.053076) +
      t * (vec3(0.01695061, -0.4635558, 1.587256))));
  vec3 b_high = vec3(-0.3543069, -1.434986, 1.880104) +
      t * (vec3(12.38502, -7.336312, -1.952615) +
      t * (vec3(-32.77022, 46.13331, -17.28112) +
      t * (vec3(9.998386, -23.47684, 12.19224))));
  return IvoryAlbedo(f0 * g_low + rise * b_low, f0 * g_high + rise * b_high);
}

// What the microfacet lobe leaves of light at cosine mu to what lies below it, and the mean of that over diffuse light.
float ivory_left_below(IvoryAlbedo e, float mu) {
  float x = 1.0 - mu;
  float sum = e.low.x + x * (e.low.y + x * (e.low.z + x * (e.high.x + x * (e.high.y + x * e.high.z))));
  return max(1.0 - sum, 0.0);
}
float ivory_mean_left_below(IvoryAlbedo e) {
  return 1.0 - dot(e.low, vec3(1.0, 1.0 / 3.0, 1.0 / 6.0)) - dot(e.high, vec3(1.0 / 10.0, 1.0 / 15.0, 1.0 / 21.0));
}

// The diffuse lobe fades where light grazes the facet: terminator() of the twin.
float ivory_terminator(IvorySurface s, vec3 w) {
  float facet = dot(w, s.ng);
  float smoothed = dot(w, s.ns) * dot(s.ns, s.ng);
  if (facet >= smoothed) return 1.0;
  float g = max(facet, 0.0) / smoothed;
  return g * (1.0 + g * (1.0 - g));
}

// f(wo, wi) dot(ns, wi) in 1/sr; 0 where either lies below ng or ns.
vec3 ivory_eval_bsdf(IvorySurface s, vec3 wi) {
  float cos_o = dot(s.ns, s.wo);
  float cos_i = dot(s.ns, wi);
  if (cos_o <= 1e-6 || cos_i <= 1e-6 || dot(s.ng, s.wo) <= 0.0 || dot(s.ng, wi) <= 0.0) return vec3(0.0);
  vec3 value = s.diffuse_albedo * (cos_i / ivory_pi * ivory_terminator(s, wi));
  if (ivory_max_component(s.f0) > 0.0 || ivory_max_component(s.f90) > 0.0) {
    IvoryAlbedo albedo = ivory_microfacet_albedo(s);
    value *= ivory_left_below(albedo, cos_o) * ivory_left_below(albedo, cos_i) /
             max(ivory_mean_left_below(albedo), 1e-3);
    vec3 sum = s.wo + wi;
    float len = length(sum);
    vec3 f = ivory_fresnel(s, 0.5 * len);
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

// What of E comes back as diffuse light: L = ivory_diffuse_reflectance / pi * E.
vec3 ivory_diffuse_reflectance(IvorySurface s) {
  float mu = dot(s.ns, s.wo);
  if (mu <= 1e-6 || dot(s.ng, s.wo) <= 0.0) return vec3(0.0);
  if (ivory_max_component(s.f0) <= 0.0 && ivory_max_component(s.f90) <= 0.0) return s.diffuse_albedo;
  return s.diffuse_albedo * ivory_left_below(ivory_microfacet_albedo(s), min(mu, 1.0));
}
