// Irradiance of an environment from nine spherical harmonics. Twin: grid/env/sh9.h, irradiance(Sh9MatricesF, n).
//
// struct IvorySh9: the symmetric matrices of eq. 12 (Ramamoorthi & Hanrahan 2001), lux, one a colour channel.
struct IvorySh9 {
  mat4 red;
  mat4 green;
  mat4 blue;
};

// E(n) in lux, never negative; n is a unit vector. Eq. 11.
vec3 ivory_irradiance(IvorySh9 sh, vec3 n) {
  vec4 v = vec4(n, 1.0);
  return max(vec3(dot(v, sh.red * v), dot(v, sh.green * v), dot(v, sh.blue * v)), 0.0);
}
