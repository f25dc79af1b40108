// Ambient light from SH9, the same everywhere. Set by bind(const GpuSh9&, ...) of runtime/assets/sh9.h.
#include "env/sh9.glsl"

uniform IvorySh9 ivory_sh9;

// E in lux at any p for the unit normal n.
vec3 ivory_ambient(vec3 p, vec3 ng, vec3 n) { return ivory_irradiance(ivory_sh9, n); }
