// Ambient light from a baked irradiance grid; runtime/assets/irradiance_grid.h: bind() sets what is declared here.
#include "field/irradiance_grid.glsl"

uniform IvoryGrid ivory_grid;
uniform sampler3D ivory_grid_volumes;
uniform sampler3D ivory_grid_trust;
uniform usampler3D ivory_grid_guard;

// E in lux at the world position p of a surface with unit geometric normal ng and unit shading normal n.
vec3 ivory_ambient(vec3 p, vec3 ng, vec3 n) {
  return ivory_lookup_irradiance(ivory_grid, ivory_grid_volumes, ivory_grid_trust, ivory_grid_guard, p, ng, n);
}
