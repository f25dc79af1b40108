#include "tracer/core/plain_surfaces.h"

#include <algorithm>
#include <cmath>

#include "tracer/core/surface_parts.h"

namespace ivory {
namespace {

bool is_plain(const Mesh& mesh, const Material& material) {
  return mesh.colors.empty() && std::all_of(std::begin(texture_slots), std::end(texture_slots),
                                            [&](auto slot) { return (material.*slot).texture == no_index; });
}

// Are the corners' normals those of the triangles themselves? Files bring normals for boxes, too.
bool has_flat_normals(const Mesh& mesh) {
  constexpr float tolerance = 1e-5F;  // radians: far below what light shows
  for (const auto& corners : mesh.triangles) {
    const V3f& a = mesh.positions[corners.x];
    const V3f ng = (mesh.positions[corners.y] - a).cross(mesh.positions[corners.z] - a).normalized();
    for (const std::uint32_t corner : {corners.x, corners.y, corners.z}) {
      if (!((mesh.normals[corner].normalized() - ng).length2() <= tolerance * tolerance)) return false;
    }
  }
  return true;
}

}  // namespace

PlainSurfaces::PlainSurfaces(const Scene& scene) : scene_(scene), instances_(scene.instances.size()) {
  std::vector<char> flat(scene.meshes.size(), 0);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    flat[m] = scene.meshes[m].normals.empty() || has_flat_normals(scene.meshes[m]) ? 1 : 0;
  for (std::size_t i = 0; i < instances_.size(); ++i) {
    const Instance& placed = scene.instances[i];
    const Mesh& mesh = scene.meshes[std::size_t(placed.mesh)];
    const Material& material = scene.materials[std::size_t(mesh.material)];
    if (!is_plain(mesh, material) || mesh.triangles.empty()) continue;
    PlainInstance& plain = instances_[i];
    plain.mesh = &mesh;
    plain.to_world = &placed.to_world;
    plain.in_place = placed.to_world == M44f();
    plain.is_flat = flat[std::size_t(placed.mesh)] != 0;
    // The material's constants are those at any hit.
    const Surface anywhere = make_surface(scene, {}, {0, V2f(0, 0), int(i), 0, V3f(0, 0, 1)});
    plain.diffuse_albedo = anywhere.diffuse_albedo;
    plain.specular_f0 = anywhere.specular_f0;
    plain.specular_f90 = anywhere.specular_f90;
    plain.roughness_alpha = anywhere.roughness_alpha;
    plain.is_lambert = is_black(plain.specular_f0) && is_black(plain.specular_f90);
  }
}

void PlainSurfaces::place(const PlainInstance& plain, const Hit& hit, Surface& surface) {
  const Imath::Vec3<std::uint32_t>& corners = plain.mesh->triangles[std::size_t(hit.triangle)];
  const std::vector<V3f>& positions = plain.mesh->positions;
  surface.p = interpolate(positions, corners, hit.barycentric);
  V3f a = positions[corners.x];
  V3f b = positions[corners.y];
  V3f c = positions[corners.z];
  if (!plain.in_place) {
    for (V3f* p : {&surface.p, &a, &b, &c}) *p = transform_point(*p, *plain.to_world);
  }
  surface.reach_m = std::max({largest_coordinate(a), largest_coordinate(b), largest_coordinate(c)});
}

Surface PlainSurfaces::make_scattering(const Ray& ray, const Hit& hit) const {
  const PlainInstance& plain = instance(hit.instance);
  if (plain.mesh == nullptr) {
    Surface surface = make_surface(scene_, ray, hit);
    surface.emission = Rgb(0, 0, 0);
    return surface;
  }
  Surface surface;
  place(plain, hit, surface);
  surface.front = ray.direction.dot(hit.ng) <= 0;
  surface.ng = surface.front ? hit.ng : -hit.ng;
  surface.ns = surface.ng;
  if (!plain.is_flat) {
    const auto& corners = plain.mesh->triangles[std::size_t(hit.triangle)];
    V3f n = interpolate(plain.mesh->normals, corners, hit.barycentric);
    n = normal_transform(*plain.to_world)(n);
    if (n.length2() > 0)
      n.normalize();
    else
      n = hit.ng;
    surface.ns = facing_normal(surface, n, ray.direction);
  }
  surface.diffuse_albedo = plain.diffuse_albedo;
  surface.specular_f0 = plain.specular_f0;
  surface.specular_f90 = plain.specular_f90;
  surface.roughness_alpha = plain.roughness_alpha;
  return surface;
}

}  // namespace ivory
