// Scenes made in memory, for sweeps and tests.
#pragma once

#include <array>
#include <string>

#include "grid/field/irradiance_grid.h"
#include "tracer/core/scene.h"

namespace ivory {

// Purely Lambertian.
inline int add_lambert(Scene& scene, const Rgb& albedo, const Rgb& emission_nits = Rgb(0, 0, 0),
                       bool double_sided = false) {
  Material material;
  material.base_color = albedo;
  material.metallic = 0;
  material.specular = 0;
  material.emission = emission_nits;
  material.double_sided = double_sided;
  scene.materials.push_back(material);
  return int(scene.materials.size()) - 1;
}

inline int add_mesh(Scene& scene, Mesh mesh, const M44f& to_world = M44f()) {
  scene.meshes.push_back(std::move(mesh));
  Instance instance;
  instance.mesh = int(scene.meshes.size()) - 1;
  instance.to_world = to_world;
  scene.instances.push_back(instance);
  return instance.mesh;
}

// Parallelogram corner + s a + t b; its front looks along a x b.
inline Mesh make_quad(const V3f& corner, const V3f& a, const V3f& b, int material) {
  Mesh mesh;
  mesh.positions = {corner, corner + a, corner + a + b, corner + b};
  mesh.triangles.emplace_back(0, 1, 2);
  mesh.triangles.emplace_back(0, 2, 3);
  mesh.uvs = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  mesh.material = material;
  return mesh;
}

// Box between two corners whose fronts look inward.
inline Mesh make_room(const V3f& low, const V3f& high, int material) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.push_back(
        {(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y, (i & 4) != 0 ? high.z : low.z});
  }
  // Corners of each face, counter-clockwise as seen from inside.
  constexpr std::array<std::array<std::uint32_t, 4>, 6> faces{
      {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  mesh.material = material;
  return mesh;
}

// Closed sphere of radius 1 about the origin, fronts inward, of 8 * 4^subdivisions triangles.
inline Mesh make_inward_sphere(int subdivisions, int material) {
  Mesh mesh;
  mesh.material = material;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 4, 2}, {2, 4, 1}, {1, 4, 3}, {3, 4, 0}, {2, 5, 0}, {1, 5, 2}, {3, 5, 1}, {0, 5, 3}};
  for (int level = 0; level < subdivisions; ++level) {
    std::vector<Imath::Vec3<std::uint32_t>> finer;
    for (const auto& t : mesh.triangles) {
      const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]).normalized());
        return static_cast<std::uint32_t>(mesh.positions.size() - 1);
      };
      const std::uint32_t ab = middle(t.x, t.y);
      const std::uint32_t bc = middle(t.y, t.z);
      const std::uint32_t ca = middle(t.z, t.x);
      for (const auto& child : {Imath::Vec3<std::uint32_t>(t.x, ab, ca), Imath::Vec3<std::uint32_t>(ab, t.y, bc),
                                Imath::Vec3<std::uint32_t>(ca, bc, t.z), Imath::Vec3<std::uint32_t>(ab, bc, ca)})
        finer.push_back(child);
    }
    mesh.triangles = finer;
  }
  return mesh;
}

// Cells that fill a cube of that side about the origin, a vertex in the middle of each.
inline GridFrame centred_frame(int vertices, float side_m) {
  GridFrame frame;
  frame.size = V3i(vertices, vertices, vertices);
  frame.spacing_m = V3f(1, 1, 1) * (side_m / float(vertices));
  const float first = (frame.spacing_m.x - side_m) / 2;
  frame.origin_m = V3f(first, first, first);
  return frame;
}

inline EnvironmentMap uniform_environment(const Rgb& radiance_nits, int height = 8) {
  EnvironmentMap map;
  map.width = 2 * height;
  map.height = height;
  map.radiance.assign(std::size_t(map.width) * std::size_t(map.height), radiance_nits);
  return map;
}

// A room with a lamp, a box that shades, and a glossy floor: every estimator has something to do.
inline Scene small_room() {
  Scene scene;
  const int white = add_lambert(scene, Rgb(0.7F, 0.7F, 0.7F));
  const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(20, 20, 20));
  Material glossy;
  glossy.base_color = Rgb(0.6F, 0.5F, 0.4F);
  glossy.metallic = 0;
  glossy.roughness = 0.4F;
  scene.materials.push_back(glossy);
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), white));
  add_mesh(scene, make_quad({-0.9F, -0.99F, -0.9F}, {0, 0, 1.8F}, {1.8F, 0, 0}, 2));    // floor, looks up
  add_mesh(scene, make_quad({-0.3F, 0.98F, -0.3F}, {0.6F, 0, 0}, {0, 0, 0.6F}, lamp));  // looks down
  Mesh box = make_room(V3f(0.1F, -0.98F, -0.4F), V3f(0.6F, -0.3F, 0.2F), white);
  for (auto& triangle : box.triangles) std::swap(triangle.y, triangle.z);  // fronts outward
  add_mesh(scene, box);
  scene.lights.push_back(PointLight{V3f(-0.5F, 0.5F, 0.5F), Rgb(0.5F, 0.5F, 0.5F)});
  return scene;
}

}  // namespace ivory
