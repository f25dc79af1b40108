#include "tracer/core/plain_surfaces.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "tracer/core/surface_parts.h"

namespace ivory {
namespace {

bool is_plain(const Mesh& mesh, const Material& material) {
  return mesh.colors.empty() && std::all_of(std::begin(texture_slots), std::end(texture_slots),
                                            [&](auto slot) { return (material.*slot).texture == no_index; });
}

// Which triangles have corners' normals that are its own: files bring normals for boxes, too.
std::vector<std::uint64_t> flat_triangles(const Mesh& mesh) {
  const std::size_t words = (mesh.triangles.size() + 63) / 64;
  if (mesh.normals.empty()) return std::vector<std::uint64_t>(words, ~std::uint64_t(0));
  constexpr float tolerance = 1e-4F;  // radians: above the rounding of small triangles, far below what light shows
  const auto is_flat = [&](const Imath::Vec3<std::uint32_t>& corners) {
    const V3f& a = mesh.positions[corners.x];
    const V3f ng = (mesh.positions[corners.y] - a).cross(mesh.positions[corners.z] - a).normalized();
    const auto agrees = [&](std::uint32_t corner) {
      return (mesh.normals[corner].normalized() - ng).length2() <= tolerance * tolerance;
    };
    return agrees(corners.x) && agrees(corners.y) && agrees(corners.z);
  };
  std::vector<std::uint64_t> flat(words, 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, words, 64), [&](const auto& range) {
    for (std::size_t word = range.begin(); word < range.end(); ++word) {
      const std::size_t end = std::min(64 * (word + 1), mesh.triangles.size());
      for (std::size_t t = 64 * word; t < end; ++t)
        flat[word] |= std::uint64_t(is_flat(mesh.triangles[t]) ? 1 : 0) << (t % 64);
    }
  });
  return flat;
}

}  // namespace

PlainSurfaces::PlainSurfaces(const Scene& scene) : scene_(scene), instances_(scene.instances.size()) {
  flat_.reserve(scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) {
    const bool plain = is_plain(mesh, scene.materials[std::size_t(mesh.material)]);
    flat_.push_back(plain ? flat_triangles(mesh) : std::vector<std::uint64_t>());
  }
  for (std::size_t i = 0; i < instances_.size(); ++i) {
    const Instance& placed = scene.instances[i];
    const Mesh& mesh = scene.meshes[std::size_t(placed.mesh)];
    const Material& material = scene.materials[std::size_t(mesh.material)];
    if (!is_plain(mesh, material) || mesh.triangles.empty()) continue;
    PlainInstance& plain = instances_[i];
    plain.mesh = &mesh;
    plain.to_world = &placed.to_world;
    plain.in_place = placed.to_world == M44f();
    plain.flat = flat_[std::size_t(placed.mesh)].data();
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
  if (!plain.is_flat(hit.triangle)) {
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
