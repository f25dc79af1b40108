// Everything that shading needs to know about a hit.
#pragma once

#include "tracer/intersector.h"
#include "tracer/scene.h"

namespace ivory {

struct Surface {
  V3f p;
  V3f ng;                     // unit geometric normal, on the side that the ray came from
  V3f ns;                     // unit shading normal (interpolated, normal-mapped), ns.ng > 0, on the ray's side
  bool front = true;          // the ray met the triangle's front side
  Rgb diffuse_albedo;         // Lambertian reflectance before Fresnel's share
  Rgb specular_f0;            // reflectance of the microfacet lobe at normal incidence
  Rgb specular_f90{1, 1, 1};  // and at grazing incidence (0 for a purely diffuse material)
  float roughness_alpha = 1;  // GGX alpha = perceptual roughness squared
  Rgb emission;               // nits, towards the ray's origin
};

Surface make_surface(const Scene& scene, const Ray& ray, const Hit& hit);

// The radiance in nits that a triangle emits from barycentric b, on the side it emits from.
Rgb emission_at(const Scene& scene, int instance, int triangle, const V2f& barycentric);

// Coverage (0 to 1) of a mesh's material there: 0 or 1 for MASK, alpha for BLEND.
float coverage_at(const Scene& scene, int mesh, int triangle, const V2f& barycentric);

}  // namespace ivory
