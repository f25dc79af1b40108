// Surfaces of plain materials, for who meets many: what is the same at every hit is worked out once.
//
// make_surface() (tracer/core/surface.h) reads colours, uv coordinates, textures and tangents where a material has
// them, and otherwise finds the same constants again at every hit. Most surfaces of most scenes are plain, and of their
// hits a photon that is absorbed needs no place at all.
#pragma once

#include <cstdint>
#include <vector>

#include "tracer/core/surface.h"

namespace ivory {

// An instance whose material has no texture and whose mesh has no colours.
struct PlainInstance {
  const Mesh* mesh = nullptr;  // null: not plain; all else is empty then
  const M44f* to_world = nullptr;
  bool in_place = false;  // to_world changes nothing
  // [triangle / 64] bit triangle % 64: the shading normals there are the geometric one, to 1e-4.
  const std::uint64_t* flat = nullptr;
  bool is_lambert = false;  // without a microfacet lobe
  Rgb diffuse_albedo{0, 0, 0};
  Rgb specular_f0{0, 0, 0};
  Rgb specular_f90{0, 0, 0};
  float roughness_alpha = 1;

  bool is_flat(int triangle) const { return (flat[triangle / 64] >> unsigned(triangle % 64) & 1U) != 0; }
};

class PlainSurfaces {
 public:
  // `scene` must outlive this object unchanged.
  explicit PlainSurfaces(const Scene& scene);
  PlainSurfaces(const PlainSurfaces&) = delete;  // instances_ points into flat_
  PlainSurfaces& operator=(const PlainSurfaces&) = delete;

  const PlainInstance& instance(int i) const { return instances_[std::size_t(i)]; }

  // p and reach_m of make_surface(), to the bit, and nothing else. For plain instances.
  static void place(const PlainInstance& plain, const Hit& hit, Surface& surface);

  // make_surface() but for emission, which is left at 0: what scatters light. The same to the bit, but for ns of flat
  // triangles, which is ng.
  Surface make_scattering(const Ray& ray, const Hit& hit) const;

 private:
  const Scene& scene_;
  std::vector<PlainInstance> instances_;
  std::vector<std::vector<std::uint64_t>> flat_;  // [mesh]
};

}  // namespace ivory
