// Emissive triangles: Lambertian emitters, on one side or on both.
#pragma once

#include <vector>

#include "tracer/lights/emission/mesh.h"
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
  Rgb mean_radiance;                       // nits, coverage included, averaged over the triangle
  const MeshEmission* emission = nullptr;  // of its mesh
};

// One triangle of an instance; with area 0 or black it is no light. `emission` must outlive it.
TriangleLight make_triangle_light(const Scene& scene, const MeshEmission& emission, int instance, int triangle);

// pi A L in lumen per channel, from both sides where the material is double-sided.
Rgb power_lm(const TriangleLight& light);

// One photon from a point of sample_point(), whose mean power is the light's flux.
EmittedPhoton emit(const Scene& scene, const TriangleLight& light, RandomStream& random);

// The same as a map of two squares, of the point and of the direction, that keeps neighbours together; the rest of a
// textured point's place is random.
EmittedPhoton emit(const Scene& scene, const TriangleLight& light, const Imath::V2d& u_point,
                   const Imath::V2d& u_direction, RandomStream& random);

// Such a point of the triangle as seen from p; nothing from a side that does not emit.
std::optional<LightSample> sample(const Scene& scene, const TriangleLight& light, const V3f& p, RandomStream& random);

// The same by two random numbers in [0, 1) that are given, which keeps neighbours together.
std::optional<LightSample> sample(const Scene& scene, const TriangleLight& light, const V3f& p, const Imath::V2d& u,
                                  RandomStream& random);

// pdf (1/sr) of that for the point at a barycentric; 0 from a side that does not emit.
float pdf_solid_angle(const Scene& scene, const TriangleLight& light, const V3f& p, const V2f& barycentric);

}  // namespace ivory
