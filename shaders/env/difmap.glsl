// Irradiance of an environment from a cube map. Twin: grid/env/difmap.h, irradiance(DifMap, n).
//
// `map` holds E / scale at the texels' centres as normals, filtered linearly and, with GL_TEXTURE_CUBE_MAP_SEAMLESS,
// across the faces' edges; `scale` is in lux.

// E(n) in lux; n need not be normalised.
vec3 ivory_irradiance(samplerCube map, float scale, vec3 n) { return textureLod(map, n, 0.0).rgb * scale; }
