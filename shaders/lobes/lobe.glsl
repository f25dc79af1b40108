// Cosine lobes s max(a.w, 0)^e around unit axes a. Twin of grid/lobes/lobe.cpp, where the closed forms are derived.
#include "base/pi.glsl"

struct IvoryLobe {
  vec3 axis;       // unit
  float exponent;  // 0 to 100000
  float scale;     // value along the axis
};

float ivory_eval_lobe(IvoryLobe lobe, vec3 w) {
  float cosine = dot(lobe.axis, w);
  return cosine > 0.0 ? lobe.scale * pow(cosine, lobe.exponent) : 0.0;
}

// Over the whole sphere.
float ivory_lobe_integral(IvoryLobe lobe) {
  return 2.0 * ivory_pi * lobe.scale / (lobe.exponent + 1.0);
}

// The lobe of any patch of directions: solid angle over 2 pi, and 1 - mean cosine to the axis (0 to 1/2).
IvoryLobe ivory_spread_lobe(vec3 axis, float height, float spread) {
  const float max_exponent = 100000.0;
  float exponent = height > 0.0 ? clamp(1.0 / max(spread, 1e-12) - 2.0, 0.0, max_exponent) : max_exponent;
  return IvoryLobe(axis, exponent, (exponent + 1.0) * max(height, 0.0));
}

// The lobe of a cap with 1 - cos(half-angle) = height, 0 to 1.
IvoryLobe ivory_cap_lobe_from_height(vec3 axis, float height) {
  float h = clamp(height, 0.0, 1.0);
  return ivory_spread_lobe(axis, h, 0.5 * h);
}

// 1 - cos of the half-angle of a sphere seen from distance_m > radius_m.
float ivory_sphere_cap_height(float radius_m, float distance_m) {
  float sine = radius_m / distance_m;
  float sine2 = min(sine * sine, 1.0);
  return sine2 / (1.0 + sqrt(1.0 - sine2));
}
