// The same light from everywhere.
uniform vec3 ivory_constant_e;  // lux

vec3 ivory_ambient(vec3 p, vec3 ng, vec3 n) { return ivory_constant_e; }
