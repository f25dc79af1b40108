// Everything that shading needs to know about a hit.
#pragma once

#include "tracer/core/intersector.h"
#include "tracer/core/scene.h"

namespace ivory {

struct Surface {
  V3f p;
  V3f ng;                       // unit geometric normal, on the side that the ray came from
  V3f ns;                       // unit shading normal (interpolated, normal-mapped), ns.ng > 0, on the ray's side
  bool front = true;            // the ray met the triangle's front side
  Rgb diffuse_albedo{0, 0, 0};  // Lambertian reflectance before Fresnel's share
  Rgb specular_f0{0, 0, 0};     // reflectance of the microfacet lobe at normal incidence
  Rgb specular_f90{1, 1, 1};    // and at grazing incidence (0 for a purely diffuse material)
  float roughness_alpha = 1;    // GGX alpha = perceptual roughness squared
  Rgb emission{0, 0, 0};        // nits, towards the ray's origin
  float reach_m = 0;            // as triangle_reach_m(); 0: not known
};

// What `ray` met at `hit`, both of the scene's intersector.
Surface make_surface(const Scene& scene, const Ray& ray, const Hit& hit);

// p moved off its surface along its unit normal ng, to the side of w, by a distance that stays above the rounding error
// of p at any scale: rays from there do not meet the surface they left. reach_m is triangle_reach_m() of the triangle
// that p lies on, 0 where it is not known.
V3f offset_origin(const V3f& p, const V3f& ng, const V3f& w, float reach_m = 0);

// A ray that leaves the surface along unit w, on either side, and does not meet it where it starts.
Ray spawn_ray(const Surface& surface, const V3f& w, std::uint32_t coverage_seed = 0);

// Largest absolute coordinate of a triangle's corners in the world, metres: the rounding error of points on it goes
// with that.
float triangle_reach_m(const Scene& scene, int instance, int triangle);

// Is `hit`, distance_m from a point along unit `direction`, the very surface of normal +-direction that the point lies
// on, but for rounding?
bool is_own_surface(const Scene& scene, const Hit& hit, float distance_m, const V3f& direction);

// reach_m of the surface with unit normal ng that p lies on to within rounding; 0 where there is none.
float own_surface_reach_m(const Intersector& intersector, const V3f& p, const V3f& ng);

// The radiance in nits that a mesh's triangle emits from barycentric b, on the side it emits from.
Rgb emission_at(const Scene& scene, int mesh, int triangle, const V2f& barycentric);

// Coverage (0 to 1) of a mesh's material at a barycentric: 0 or 1 for MASK, alpha for BLEND, times the share that it
// does not transmit.
float coverage_at(const Scene& scene, int mesh, int triangle, const V2f& barycentric);

}  // namespace ivory
