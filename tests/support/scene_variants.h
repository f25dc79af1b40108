// The same scene given in other ways, none of which may change its light.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "tracer/core/scene.h"

namespace ivory {

struct SceneVariant {
  std::string name;
  Scene scene;
  M44f to_world{};           // takes the original's world to the variant's: a similarity
  M33f rotation{};           // of that
  float metres_a_metre = 1;  // its scale
};

inline M44f as_matrix(const M33f& rotation, float scale, const V3f& shift) {
  M44f m;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) m[row][column] = scale * rotation[row][column];
  for (int axis = 0; axis < 3; ++axis) m[3][axis] = shift[axis];
  return m;
}

// E stays where lengths are multiplied by `scale` if intensities are multiplied by its square.
inline SceneVariant moved(std::string name, Scene scene, const M33f& rotation, float scale, const V3f& shift) {
  const M44f m = as_matrix(rotation, scale, shift);
  for (Instance& instance : scene.instances) instance.to_world = instance.to_world * m;
  for (PunctualLight& light : scene.lights) {
    if (auto* point = std::get_if<PointLight>(&light)) {
      point->position = point->position * m;
      point->intensity_cd *= scale * scale;
    } else if (auto* spot = std::get_if<SpotLight>(&light)) {
      spot->position = spot->position * m;
      spot->direction = spot->direction * rotation;
      spot->intensity_cd *= scale * scale;
    } else {
      auto& sun = std::get<DirectionalLight>(light);
      sun.direction = sun.direction * rotation;
    }
  }
  return {std::move(name), std::move(scene), m, rotation, scale};
}

// Each triangle as the four that its edges' middles make.
inline Scene subdivided(Scene scene) {
  for (Mesh& mesh : scene.meshes) {
    std::vector<Imath::Vec3<std::uint32_t>> finer;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]) / 2.0F);
      for (auto& uv : mesh.uvs)
        if (!uv.empty()) uv.push_back((uv[a] + uv[b]) / 2.0F);
      return std::uint32_t(mesh.positions.size() - 1);
    };
    for (const auto& t : mesh.triangles) {
      const std::uint32_t ab = middle(t.x, t.y);
      const std::uint32_t bc = middle(t.y, t.z);
      const std::uint32_t ca = middle(t.z, t.x);
      finer.emplace_back(t.x, ab, ca);
      finer.emplace_back(ab, t.y, bc);
      finer.emplace_back(ca, bc, t.z);
      finer.emplace_back(ab, bc, ca);
    }
    mesh.triangles = std::move(finer);
  }
  return scene;
}

// A mesh of its own for each instance, with the transform in its vertices. For meshes without normals and tangents.
inline Scene uninstanced(Scene scene) {
  std::vector<Mesh> meshes;
  for (Instance& instance : scene.instances) {
    Mesh mesh = scene.meshes[std::size_t(instance.mesh)];
    for (V3f& p : mesh.positions) p = p * instance.to_world;
    if (instance.to_world.determinant() < 0)
      for (auto& t : mesh.triangles) std::swap(t.y, t.z);
    instance.mesh = int(meshes.size());
    instance.to_world = M44f();
    meshes.push_back(std::move(mesh));
  }
  scene.meshes = std::move(meshes);
  return scene;
}

inline Scene reversed(Scene scene) {
  std::reverse(scene.instances.begin(), scene.instances.end());
  std::reverse(scene.lights.begin(), scene.lights.end());
  std::reverse(scene.meshes.begin(), scene.meshes.end());
  for (Instance& instance : scene.instances) instance.mesh = int(scene.meshes.size()) - 1 - instance.mesh;
  for (Mesh& mesh : scene.meshes) std::reverse(mesh.triangles.begin(), mesh.triangles.end());
  return scene;
}

// Of a scene without environment.
inline std::vector<SceneVariant> variants(const Scene& scene) {
  const M33f upright;
  const M33f quarter(0, 0, -1, 0, 1, 0, 1, 0, 0);  // about +Y
  M44f turn;
  turn.setEulerAngles(V3f(0.4F, 0.9F, -0.3F));
  const M33f askew(turn[0][0], turn[0][1], turn[0][2], turn[1][0], turn[1][1], turn[1][2], turn[2][0], turn[2][1],
                   turn[2][2]);
  std::vector<SceneVariant> all;
  all.push_back(moved("shifted", scene, upright, 1, V3f(300, -20, 100)));
  all.push_back(moved("turned a quarter", scene, quarter, 1, V3f(0, 0, 0)));
  all.push_back(moved("turned", scene, askew, 1, V3f(0, 0, 0)));
  all.push_back(moved("in centimetres", scene, upright, 100, V3f(0, 0, 0)));
  all.push_back({"subdivided", subdivided(scene)});
  all.push_back({"uninstanced", uninstanced(scene)});
  all.push_back({"reversed", reversed(scene)});
  return all;
}

}  // namespace ivory
