// Surfaces of plain materials, for who meets many: what is the same at every hit is worked out once.
//
// make_surface() (tracer/core/surface.h) reads colours, uv coordinates, textures and tangents where a material has
// them, and otherwise finds the same constants again at every hit. Most surfaces of most scenes are plain, and of their
// hits a photon that is absorbed needs no place at all.
#pragma once

#include <vector>

#include "tracer/core/surface.h"

namespace ivory {

// An instance whose material has no texture and whose mesh has no colours.
struct PlainInstance {
  const Mesh* mesh = nullptr;  // null: not plain; all else is empty then
  const M44f* to_world = nullptr;
  bool in_place = false;    // to_world changes nothing
  bool is_flat = false;     // the shading normal is the geometric one, to 1e-5
  bool is_lambert = false;  // without a microfacet lobe
  Rgb diffuse_albedo{0, 0, 0};
  Rgb specular_f0{0, 0, 0};
  Rgb specular_f90{0, 0, 0};
  float roughness_alpha = 1;
};

class PlainSurfaces {
 public:
  // `scene` must outlive this object unchanged.
  explicit PlainSurfaces(const Scene& scene);

  const PlainInstance& instance(int i) const { return instances_[std::size_t(i)]; }

  // p and reach_m of make_surface(), to the bit, and nothing else. For plain instances.
  static void place(const PlainInstance& plain, const Hit& hit, Surface& surface);

  // make_surface() but for emission, which is left at 0: what scatters light. The same to the bit, but for ns of flat
  // instances, which is ng.
  Surface make_scattering(const Ray& ray, const Hit& hit) const;

 private:
  const Scene& scene_;
  std::vector<PlainInstance> instances_;
};

}  // namespace ivory
