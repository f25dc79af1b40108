// Emissive triangles: Lambertian emitters, on one side or on both.
#pragma once

#include <vector>

#include "tracer/lights/lights.h"

namespace ivory {

struct TriangleLight {
  V3f vertex;  // world
  V3f edge1;
  V3f edge2;
  V3f ng;  // unit, world, of the front side: the side that emits
  float area_m2 = 0;
  float reach_m = 0;  // as triangle_reach_m()
  bool double_sided = false;
  int instance = no_index;
  int triangle = no_index;
  Rgb mean_radiance;  // nits, coverage included, averaged over the triangle
};

// All triangles of the scene whose material emits, in the order of instances and triangles;
// those without area or with no light at all (black texels) are left out.
std::vector<TriangleLight> make_triangle_lights(const Scene& scene);

// pi A L in lumen per channel, from both sides where the material is double-sided.
Rgb power_lm(const TriangleLight& light);

// One photon from a uniform point, whose mean power is the light's flux.
EmittedPhoton emit(const Scene& scene, const TriangleLight& light, RandomStream& random);

// A uniform point of the triangle as seen from p; nothing from a side that does not emit.
std::optional<LightSample> sample(const Scene& scene, const TriangleLight& light, const V3f& p, RandomStream& random);

// pdf (1/sr) of that for the point at a barycentric; 0 from a side that does not emit.
float pdf_solid_angle(const TriangleLight& light, const V3f& p, const V2f& barycentric);

}  // namespace ivory
