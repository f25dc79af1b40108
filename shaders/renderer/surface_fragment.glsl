// Fragment stage of ivory::Renderer. Before it stand an object's source of ambient light (runtime/assets/ambient.h)
// and, where a program brings its own, ivory_output().
#include "renderer/surface.glsl"
#include "renderer/punctual_lights.glsl"

uniform bool ivory_direct;     // add direct light?
uniform bool ivory_emissive;   // and emission?
uniform float ivory_exposure;  // factor on all radiance

out vec4 ivory_fragment;

void main() {
  IvorySurface s = ivory_make_surface();
  if (s.coverage <= 0.0) discard;
#ifdef IVORY_OUTPUT
  vec3 radiance = ivory_output(s);
#else
#ifdef IVORY_AMBIENT_RADIANCE
  vec3 radiance = ivory_ambient_radiance(s);
#else
  vec3 radiance = ivory_diffuse_reflectance(s) / ivory_pi * ivory_ambient(s.p, s.ng, s.ns);
#endif
  if (ivory_emissive) radiance += s.emission;
  if (ivory_direct) radiance += ivory_direct_light(s);
#endif
  ivory_fragment = vec4(radiance * ivory_exposure, s.coverage);
}
