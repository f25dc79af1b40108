// Fits a set of spheres to a mesh: the variational sphere-set approximation of Wang et al. (2006) in voxels.
#pragma once

#include <functional>
#include <string>

#include "grid/lobes/sphere_set.h"
#include "tracer/core/scene.h"

namespace ivory {

struct SphereFitParams {
  int count = 64;      // 1 to 4096; fewer come back where more would gain nothing
  int resolution = 0;  // voxels along the longest side, 16 to 192; 0: from the count
  int rounds = 12;     // of refinement at most; it ends when nothing improves
  std::function<void(double)> progress;
};

// How the union of the spheres differs from the mesh, on points that the fit did not see. Volumes over the mesh's own,
// over its bounding sphere's where it is no solid; distances over the radius of its bounding sphere.
struct SphereFitErrors {
  double mesh_volume_m3 = 0;     // enclosed; 0 for sheets
  double volume_outside = 0;     // of the spheres beyond the mesh
  double volume_uncovered = 0;   // of the mesh beyond the spheres
  double surface_uncovered = 0;  // fraction of the mesh's area farther than 2 % beyond the spheres
  double surface_mean = 0;       // mean distance between mesh surface and union's surface, seen from the mesh
  double surface_farthest = 0;   // farthest that the mesh stands out of the spheres
  double bounding_radius_m = 0;
};

struct SphereFit {
  SphereSet set;
  SphereFitErrors errors;
  int resolution = 0;
  bool solid = false;         // the mesh encloses volume; otherwise spheres cover its surface
  double surface_weight = 0;  // what a voxel of surface counts beyond its volume; above 0 for thin parts
};

// All triangles of the scene in world space but spherical lights; open, inside-out and self-intersecting meshes are
// fine, and closed ones whose triangles run both ways. Deterministic. Throws Error (naming scene.name) where there is
// nothing to fit to: no triangle with area, or extents beyond float.
SphereFit fit_spheres(const Scene& scene, const SphereFitParams& params);

}  // namespace ivory
