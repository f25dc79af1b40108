// An object's ambient light from a localized cube map; filled by ivory::bind(GpuLocalizedCube). Define
// IVORY_CUBEMAP_METHOD before it to read the map otherwise than by polygons cut at the horizon: ivory_cube_point,
// ivory_cube_polygon_paper or ivory_cube_convolved.
#include "cubemap/localized.glsl"

#ifndef IVORY_CUBEMAP_METHOD
#define IVORY_CUBEMAP_METHOD ivory_cube_polygon
#endif

uniform IvoryLocalizedCube ivory_cubemap;
uniform samplerBuffer ivory_cubemap_texels;

// E in lux at world p for unit shading normal n; nothing shadows it.
vec3 ivory_ambient(vec3 p, vec3 ng, vec3 n) { return IVORY_CUBEMAP_METHOD(ivory_cubemap, ivory_cubemap_texels, p, n); }
