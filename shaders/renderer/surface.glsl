// The surface under a fragment of ivory::Renderer, as tracer/core/surface.cpp makes it of a hit.
#include "renderer/bsdf.glsl"

in vec3 ivory_p;
in vec3 ivory_from_eye;
in vec3 ivory_n;
in vec4 ivory_t;
in vec4 ivory_uv;
in vec4 ivory_color;

uniform vec4 ivory_eye;          // w 1: position; w 0: direction towards an orthographic eye
uniform vec4 ivory_base_color;   // and alpha
uniform vec4 ivory_surface;      // metallic, roughness, dielectric f90, 1 for specular-glossiness
uniform vec3 ivory_dielectric_f0;
uniform vec4 ivory_emission;     // nits, and alpha cutoff: -1 opaque, -2 blend
uniform vec4 ivory_shading;      // normal map's scale, 1 for normals, 1 for a normal map, handedness of the placement
uniform bool ivory_double_sided;

// Base colour, surface, normal, emission: 1 where there is one; rows of the uv transform; which uv set.
uniform ivec4 ivory_has_texture;
uniform vec4 ivory_uv_rows[8];  // (m0 m1 m2 set), (m3 m4 m5 0) for each
uniform sampler2D ivory_textures[4];

vec2 ivory_uv_of(int use) {
  vec4 u = ivory_uv_rows[2 * use];
  vec4 v = ivory_uv_rows[2 * use + 1];
  vec3 at = vec3(u.w > 0.5 ? ivory_uv.zw : ivory_uv.xy, 1.0);
  return vec2(dot(u.xyz, at), dot(v.xyz, at));
}

vec4 ivory_base() {
  vec4 color = ivory_base_color * ivory_color;
  if (ivory_has_texture.x != 0) color *= texture(ivory_textures[0], ivory_uv_of(0));
  return color;
}

float ivory_coverage(float alpha) {
  if (ivory_emission.w == -1.0) return 1.0;
  return ivory_emission.w == -2.0 ? clamp(alpha, 0.0, 1.0) : alpha >= ivory_emission.w ? 1.0 : 0.0;
}

vec3 ivory_shading_normal(vec3 front_ng) {
  // Before any return that some fragments take: the filter needs all of a group.
  vec3 texel = ivory_shading.z == 0.0 ? vec3(0.0) : texture(ivory_textures[2], ivory_uv_of(2)).xyz * 2.0 - 1.0;
  if (ivory_shading.y == 0.0 || dot(ivory_n, ivory_n) <= 0.0) return front_ng;
  vec3 n = normalize(ivory_n);
  if (ivory_shading.z == 0.0) return n;
  vec3 t = ivory_t.xyz - n * dot(n, ivory_t.xyz);
  if (dot(t, t) <= 0.0) return n;
  t = normalize(t);
  vec3 b = cross(n, t) * ((ivory_t.w < 0.0 ? -1.0 : 1.0) * ivory_shading.w);
  vec3 mapped = t * (texel.x * ivory_shading.x) + b * (texel.y * ivory_shading.x) + n * texel.z;
  return dot(mapped, mapped) > 0.0 ? normalize(mapped) : n;
}

IvorySurface ivory_make_surface() {
  IvorySurface s;
  s.p = ivory_p;
  s.wo = ivory_eye.w > 0.5 ? normalize(ivory_eye.xyz - ivory_p) : ivory_eye.xyz;
  // Relative to the eye, where differences keep their digits however far the scene lies from the origin.
  vec3 ng = normalize(cross(dFdx(ivory_from_eye), dFdy(ivory_from_eye)));
  if (dot(ng, s.wo) < 0.0) ng = -ng;
  s.ng = ng;
  s.ns = ivory_shading_normal(gl_FrontFacing ? ng : -ng);
  if (!gl_FrontFacing) s.ns = -s.ns;
  if (dot(s.ns, s.ng) <= 0.0) s.ns = s.ng;
  float cosine = dot(s.ns, s.wo);
  if (cosine < 0.01 && dot(s.ng, s.wo) > cosine) s.ns = normalize(s.ns + s.wo * (0.01 - cosine));

  vec4 base = ivory_base();
  s.coverage = ivory_coverage(base.a);
  vec4 texel = vec4(1.0);
  if (ivory_has_texture.y != 0) texel = texture(ivory_textures[1], ivory_uv_of(1));
  float roughness;
  if (ivory_surface.w != 0.0) {
    s.f0 = ivory_dielectric_f0 * texel.rgb;
    s.f90 = vec3(ivory_max_component(s.f0) > 0.0 ? 1.0 : 0.0);
    s.diffuse_albedo = base.rgb * (1.0 - clamp(ivory_max_component(s.f0), 0.0, 1.0));
    roughness = 1.0 - clamp((1.0 - ivory_surface.y) * texel.a, 0.0, 1.0);
  } else {
    float metallic = clamp(ivory_surface.x * texel.b, 0.0, 1.0);
    roughness = clamp(ivory_surface.y * texel.g, 0.0, 1.0);
    s.diffuse_albedo = base.rgb * (1.0 - metallic);
    s.f0 = ivory_dielectric_f0 * (1.0 - metallic) + base.rgb * metallic;
    s.f90 = vec3(ivory_surface.z * (1.0 - metallic) + metallic);
  }
  s.diffuse_albedo = clamp(s.diffuse_albedo, 0.0, 1.0);
  s.f0 = clamp(s.f0, 0.0, 1.0);
  s.alpha = clamp(roughness * roughness, 1e-3, 1.0);
  s.emission = vec3(0.0);
  if (gl_FrontFacing || ivory_double_sided) {
    s.emission = ivory_emission.rgb;
    if (ivory_has_texture.w != 0) s.emission *= texture(ivory_textures[3], ivory_uv_of(3)).rgb;
  }
  return s;
}
