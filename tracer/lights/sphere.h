// Spherical lights as emissive meshes, so that every method that traces rays sees them.
#pragma once

#include "tracer/core/scene.h"

namespace ivory {

// Adds the light to scene.sphere_lights and, in its place, a mesh of 5120 emissive triangles of the sphere's surface
// area. By Cauchy's theorem a convex body's mean shadow is a quarter of its area: the mesh sends out the sphere's light
// exactly in the mean over directions, and to 0.1 % in each. Throws Error (naming `source`) for a light that is not
// finite, has no radius, or is so small and far out that its triangles vanish in rounding.
void add_sphere_light(Scene& scene, const SphereLight& light, const std::string& source);

}  // namespace ivory
