// A solid as a set of spheres, which occludes light by cones.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "grid/base/metadata.h"
#include "grid/base/types.h"

namespace ivory {

struct Sphere {
  V3f center;
  float radius_m = 0;
};

struct SphereSet {
  std::vector<Sphere> spheres;
  V3d anchor_m{0, 0, 0};  // centres plus this are the world's: grid/base/anchor.h
  Metadata metadata;      // how it was fitted, and how well
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

// Spheres in groups of neighbours, each with a sphere around it, to leave out most of them at once.
struct SphereGroups {
  struct Group {
    Sphere bounds;
    std::uint32_t first = 0;  // of its spheres
    std::uint32_t count = 0;
  };
  std::vector<Sphere> spheres;
  std::vector<Group> groups;
};
SphereGroups make_sphere_groups(std::vector<Sphere> spheres);  // any number, in any order

// A cone of directions from a point: unit axis, cosine and sine of its half-angle, which is at most a right angle.
struct Cone {
  V3f apex;
  V3f axis;
  float cosine = 1;
  float sine = 0;
};

// May the sphere hide directions of the cone? Always true where it holds the apex.
inline bool may_hide(const Sphere& sphere, const Cone& cone) {
  const float tangent2 = power(sphere, cone.apex);
  if (!(tangent2 > 0)) return true;
  // cos(angle) > cos(a + b) for the half-angles a and b; a + b stays below the half turn.
  return (sphere.center - cone.apex).dot(cone.axis) > std::sqrt(tangent2) * cone.cosine - sphere.radius_m * cone.sine;
}

// Replaces `found` by the spheres that may hide directions of the cone, but for those that hold its apex.
void find_hiding(const SphereGroups& groups, const Cone& cone, std::vector<Sphere>& found);

}  // namespace ivory
