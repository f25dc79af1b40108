// Ambient light from a DifMap, the same everywhere. Set by bind(const GpuDifMap&, ...) of runtime/assets/difmap.h.
#include "env/difmap.glsl"

uniform samplerCube ivory_difmap_e;
uniform float ivory_difmap_scale;  // lux
uniform mat3 ivory_difmap_from_world;  // turns normals back to how the map was baked: has no default, set it

// E in lux at any p for the unit normal n.
vec3 ivory_ambient(vec3 p, vec3 ng, vec3 n) {
  return ivory_irradiance(ivory_difmap_e, ivory_difmap_scale, ivory_difmap_from_world * n);
}
