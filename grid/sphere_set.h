// A solid as a set of spheres, which occludes light by cones.
#pragma once

#include <vector>

#include "grid/metadata.h"
#include "grid/types.h"

namespace ivory {

struct Sphere {
  V3f center;
  float radius_m = 0;
};

struct SphereSet {
  std::vector<Sphere> spheres;
  Metadata metadata;  // how it was fitted, and how well
};

// Squared length of the tangent from p to the sphere: negative inside. Of two spheres that do not meet, the one with
// the smaller power is the nearer one along every ray from p through both (the order of power diagrams).
inline float power(const Sphere& sphere, const V3f& p) {
  return (sphere.center - p).length2() - sphere.radius_m * sphere.radius_m;
}

// Does the ray from p along unit w meet the sphere? p lies outside it.
inline bool meets(const Sphere& sphere, const V3f& p, const V3f& w) {
  const V3f d = sphere.center - p;
  const float along = d.dot(w);
  return along > 0 && (d - w * along).length2() < sphere.radius_m * sphere.radius_m;
}

}  // namespace ivory
