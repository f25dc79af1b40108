// Direct light of point, spot and directional lights with shadow maps; filled by ivory::LightSet
// (runtime/renderer/punctual_light.h). The lights' formulas are those of tracer/lights/punctual.cpp.
#include "renderer/bsdf.glsl"

struct IvoryLight {
  vec4 position_kind;    // world m; 0 point, 1 spot, 2 directional, 3 patch
  vec4 direction_outer;  // unit, the way the light travels, patches: normal; spots: 1 - cosine of the outer angle;
                         // directional: sr, patches: m2 that they stand for
  vec4 intensity_width;  // cd, or lux for directional; inner minus outer cosine
  vec4 shadow;           // first layer or -1; world size of a shadow texel (at distance 1 m unless directional)
};
layout(std140) uniform IvoryLights {
  int ivory_light_count;
  IvoryLight ivory_lights[32];
  mat4 ivory_shadow_clip_from_world[64];
};
uniform sampler2DArrayShadow ivory_shadow_maps;

// The layer of a point light's cube that looks from the light along d.
int ivory_cube_layer(vec3 d) {
  vec3 a = abs(d);
  if (a.x >= a.y && a.x >= a.z) return d.x > 0.0 ? 0 : 1;
  if (a.y >= a.z) return d.y > 0.0 ? 2 : 3;
  return d.z > 0.0 ? 4 : 5;
}

// Share of the light that reaches p: four bilinear comparisons, half a texel apart. The receiver is moved out along its
// normal by as much as a texel can be wrong there.
float ivory_lit(IvoryLight light, vec3 p, vec3 ng, vec3 to_light) {
  if (light.shadow.x < 0.0) return 1.0;
  bool directional = light.position_kind.w == 2.0;
  float texel = light.shadow.y * (directional ? 1.0 : length(to_light));
  float sine = length(cross(ng, normalize(to_light)));
  vec3 moved = p + ng * (texel * (0.5 + 2.0 * sine));
  int layer = int(light.shadow.x);
  if (light.position_kind.w == 0.0 || light.position_kind.w == 3.0) layer += ivory_cube_layer(moved - light.position_kind.xyz);
  vec4 clip = ivory_shadow_clip_from_world[layer] * vec4(moved, 1.0);
  if (clip.w <= 0.0) return 1.0;
  vec3 at = clip.xyz / clip.w * 0.5 + 0.5;
  if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
  vec2 half_texel = 0.5 / vec2(textureSize(ivory_shadow_maps, 0).xy);
  float lit = 0.0;
  for (int i = 0; i < 4; ++i) {
    vec2 offset = vec2((i & 1) == 0 ? -1.0 : 1.0, (i & 2) == 0 ? -1.0 : 1.0) * half_texel;
    // Explicit gradients of zero: there are no levels to choose from, and control flow is not uniform.
    lit += textureGrad(ivory_shadow_maps, vec4(at.xy + offset, float(layer), at.z), vec2(0.0), vec2(0.0));
  }
  return 0.25 * lit;
}

// The surface as it reflects a light of that solid angle taken for a point: rougher, so that the highlight is about as
// wide as the light's image would be. A cone of sr solid angle reaches sqrt(sr / pi) from its axis, half-vectors half of
// that. (After Karis, "Real Shading in Unreal Engine 4", 2013.)
IvorySurface ivory_widened(IvorySurface s, float sr) {
  s.alpha = min(1.0, sqrt(s.alpha * s.alpha + sr / (4.0 * ivory_pi)));
  return s;
}

// Radiance in nits that the surface reflects towards s.wo of light that comes straight from the lights.
vec3 ivory_direct_light(IvorySurface s) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < ivory_light_count; ++i) {
    IvoryLight light = ivory_lights[i];
    bool directional = light.position_kind.w == 2.0;
    vec3 to_light = directional ? -light.direction_outer.xyz : light.position_kind.xyz - s.p;
    float distance2 = dot(to_light, to_light);
    vec3 w = to_light * inversesqrt(distance2);
    vec3 e = light.intensity_width.rgb;
    float sr = directional ? light.direction_outer.w : 0.0;
    if (light.position_kind.w == 3.0) {
      // Light that leaves by the cosine from a disc of that area, whose irradiance on its axis r^2 + A / pi divides:
      // never more than a surface of its radiance could give, however near.
      float cosine = max(0.0, -dot(w, light.direction_outer.xyz));
      float area = light.direction_outer.w;
      float share = cosine / (distance2 + area / ivory_pi);
      e *= share;
      sr = area * share;
    } else if (!directional) {
      e /= distance2;
    }
    if (light.position_kind.w == 1.0) {
      // 1 - cosine from the axis, by the sine: the difference would lose narrow cones.
      float cosine = dot(-w, light.direction_outer.xyz);
      vec3 sine = cross(w, light.direction_outer.xyz);
      float x = cosine > 0.0 ? dot(sine, sine) / (1.0 + cosine) : 1.0 - cosine;
      float a = clamp((light.direction_outer.w - x) / light.intensity_width.a, 0.0, 1.0);
      e *= a * a;
    }
    vec3 reflected = e * ivory_eval_bsdf(ivory_widened(s, sr), w);
    if (ivory_max_component(reflected) > 0.0) sum += reflected * ivory_lit(light, s.p, s.ng, to_light);
  }
  return sum;
}
