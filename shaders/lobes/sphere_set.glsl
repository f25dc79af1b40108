// Spheres that occlude light by cones. Twin of grid/lobes/sphere_set.h. A sphere is (centre, radius), metres.

// Squared length of the tangent from p: negative inside; the order of spheres along rays from p.
float ivory_power(vec4 sphere, vec3 p) {
  vec3 d = sphere.xyz - p;
  return dot(d, d) - sphere.w * sphere.w;
}

// May the sphere hide directions of the cone from `apex` with that axis, cosine and sine of the half-angle?
bool ivory_may_hide(vec4 sphere, vec3 apex, vec3 axis, float cosine, float sine) {
  float tangent2 = ivory_power(sphere, apex);
  if (!(tangent2 > 0.0)) return true;
  return dot(sphere.xyz - apex, axis) > sqrt(tangent2) * cosine - sphere.w * sine;
}
