// An object's light from spherical lights by cosine lobes, with soft shadows from sphere sets; filled by
// ivory::bind(GpuLobes). This is direct light: it stands where other methods have indirect or environment light.
//
//   ivory_ambient(p, ng, n)      E in lux, for a Lambert surface.
//   ivory_lobe_radiance(...)     radiance in nits of a Lambert and a Phong lobe, where IVORY_LOBES_GLOSSY is defined;
//                                for ivory::Renderer then ivory_ambient_radiance(s) too, instead of ivory_ambient().
// For other reflectances fill an IvoryReflectanceLobes (lobes/light.glsl) and call
//   ivory_lobe_light(ivory_lobes, ivory_lobe_scene, ivory_lobe_blocks, ivory_lobe_integrals, p, ns, lobes).
#ifdef IVORY_LOBES_GLOSSY
#define IVORY_AMBIENT_RADIANCE
#elif !defined(IVORY_MAX_LOBES)
#define IVORY_MAX_LOBES 1
#endif
// For both kinds: inclusion does not see #if.
#include "renderer/bsdf.glsl"
#include "lobes/light.glsl"

uniform IvoryLobeLights ivory_lobes;
uniform samplerBuffer ivory_lobe_scene;
uniform samplerBuffer ivory_lobe_blocks;
uniform sampler3D ivory_lobe_integrals;

#ifdef IVORY_LOBES_GLOSSY
uniform sampler3D ivory_lobe_products;

// Towards wo; roughness_alpha is glTF's roughness squared.
vec3 ivory_lobe_radiance(vec3 p, vec3 ns, vec3 wo, vec3 diffuse_albedo, vec3 specular_f0, float roughness_alpha) {
  return ivory_lobe_light(
      ivory_lobes, ivory_lobe_scene, ivory_lobe_blocks, ivory_lobe_integrals, p, ns,
      ivory_phong_lobes(ivory_lobes.table, ivory_lobe_products, ns, wo, diffuse_albedo, specular_f0, roughness_alpha));
}

vec3 ivory_ambient_radiance(IvorySurface s) {
  return ivory_lobe_radiance(s.p, s.ns, s.wo, s.diffuse_albedo, s.f0, s.alpha);
}
#else
vec3 ivory_ambient(vec3 p, vec3 ng, vec3 n) {
  return ivory_lobe_light(ivory_lobes, ivory_lobe_scene, ivory_lobe_blocks, ivory_lobe_integrals, p, n,
                          ivory_lambert_lobes(n, vec3(1.0)));
}
#endif
