// What every loaded scene must satisfy, whatever file it came from.
#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tracer/core/scene.h"

namespace ivory {

// The folder of sample data, which IVORY_DATA names; empty where it names none. Tests that need it are skipped then,
// with a message that says no_sample_data.
inline std::string sample_data() {
  const char* folder = std::getenv("IVORY_DATA");
  return folder != nullptr && std::filesystem::is_directory(folder) ? folder : "";
}
inline constexpr const char* no_sample_data = "needs the sample data: set IVORY_DATA to its folder";

namespace scene_check {

template <class Vector>
bool finite(const Vector& v) {
  for (unsigned i = 0; i < Vector::dimensions(); ++i)
    if (!std::isfinite(v[int(i)])) return false;
  return true;
}

inline bool finite(const M44f& m) {
  for (int i = 0; i < 16; ++i)
    if (!std::isfinite(m[i / 4][i % 4])) return false;
  return true;
}

inline std::string check_mesh(const Scene& scene, const Mesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  if (mesh.triangles.empty()) return "a mesh without triangles";
  if (mesh.material < 0 || std::size_t(mesh.material) >= scene.materials.size()) return "no such material";
  for (const auto& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c)
      if (t[c] >= vertices) return "index out of range";
    const V3f e = (mesh.positions[t.y] - mesh.positions[t.x]).cross(mesh.positions[t.z] - mesh.positions[t.x]);
    if (!(e.length2() > 0) || !std::isfinite(e.length2())) return "a triangle without finite area";
  }
  const auto sized = [vertices](std::size_t n) { return n == 0 || n == vertices; };
  if (!sized(mesh.normals.size()) || !sized(mesh.tangents.size()) || !sized(mesh.colors.size()))
    return "attribute sizes";
  for (const V3f& p : mesh.positions)
    if (!finite(p)) return "a position that is not finite";
  for (const V3f& n : mesh.normals)
    if (!(std::abs(n.length() - 1) < 1e-4F)) return "a normal that is not of unit length";
  for (const V4f& t : mesh.tangents)
    if (!(std::abs(V3f(t.x, t.y, t.z).length() - 1) < 1e-4F) || std::abs(t.w) != 1) return "a bad tangent";
  for (const V4f& c : mesh.colors)
    for (int k = 0; k < 4; ++k)
      if (!(c[k] >= 0 && c[k] <= 1)) return "a colour out of range";
  for (const auto& uv : mesh.uvs) {
    if (!sized(uv.size())) return "uv sizes";
    for (const V2f& p : uv)
      if (!finite(p)) return "a uv that is not finite";
  }
  const Material& m = scene.materials[std::size_t(mesh.material)];
  for (const auto slot : texture_slots) {
    const TextureUse* use = &(m.*slot);
    if (use->texture == no_index) continue;
    if (std::size_t(use->uv_set) >= mesh.uvs.size() || mesh.uvs[std::size_t(use->uv_set)].empty())
      return "missing uv set";
  }
  if (m.normal_texture.texture != no_index && (mesh.tangents.empty() || mesh.normals.empty()))
    return "a normal map without tangents";
  return "";
}

inline std::string check_material(const Scene& scene, const Material& m) {
  for (int k = 0; k < 3; ++k) {
    if (!(m.base_color[k] >= 0 && m.base_color[k] <= 1)) return "base colour out of range";
    if (!(m.emission[k] >= 0) || !std::isfinite(m.emission[k])) return "emission out of range";
    if (!(m.specular_color[k] >= 0) || !std::isfinite(m.specular_color[k])) return "specular colour out of range";
  }
  for (const float x : {m.alpha, m.metallic, m.roughness, m.specular, m.glossiness, m.transmission})
    if (!(x >= 0 && x <= 1)) return "a factor out of range";
  if (!(m.ior == 0 || m.ior >= 1)) return "ior out of range";
  for (const auto slot : texture_slots) {
    const TextureUse* use = &(m.*slot);
    if (use->texture == no_index) continue;
    if (use->texture < 0 || std::size_t(use->texture) >= scene.textures.size()) return "no such texture";
    for (const float x : use->uv_transform)
      if (!std::isfinite(x)) return "a uv transform that is not finite";
  }
  return "";
}

struct CheckLight {
  std::string operator()(const PointLight& l) const {
    return strength(l.intensity_cd) && finite(l.position) ? "" : "point";
  }
  std::string operator()(const SpotLight& l) const {
    const bool good = strength(l.intensity_cd) && finite(l.position) && unit(l.direction) && l.inner_angle_rad >= 0 &&
                      l.inner_angle_rad <= l.outer_angle_rad && l.outer_angle_rad > 0 &&
                      l.outer_angle_rad <= 1.5707964F;
    return good ? "" : "spot";
  }
  std::string operator()(const DirectionalLight& l) const {
    return strength(l.illuminance_lux) && unit(l.direction) ? "" : "directional";
  }
  static bool unit(const V3f& d) { return std::abs(d.length() - 1) < 1e-5F; }
  static bool strength(const Rgb& c) { return finite(V3f(c)) && c.x >= 0 && c.y >= 0 && c.z >= 0; }
};

}  // namespace scene_check

// Empty for a consistent scene, else what is wrong with it.
inline std::string find_fault(const Scene& scene) {
  using namespace scene_check;
  for (const Mesh& mesh : scene.meshes)
    if (const std::string fault = check_mesh(scene, mesh); !fault.empty()) return "mesh " + mesh.name + ": " + fault;
  for (const Material& m : scene.materials)
    if (const std::string fault = check_material(scene, m); !fault.empty()) return "material " + m.name + ": " + fault;
  for (const Texture& t : scene.textures)
    if (t.image != no_index && (t.image < 0 || std::size_t(t.image) >= scene.images.size())) return "no such image";
  for (const Image& image : scene.images) {
    if (image.width < 1 || image.height < 1) return "an empty image";
    if (image.rgba.size() != std::size_t(image.width) * std::size_t(image.height) * 4) return "image size";
  }
  for (const Instance& instance : scene.instances) {
    if (instance.mesh < 0 || std::size_t(instance.mesh) >= scene.meshes.size()) return "no such mesh";
    if (!finite(instance.to_world)) return "a transform that is not finite";
    if (instance.to_world[0][3] != 0 || instance.to_world[1][3] != 0 || instance.to_world[2][3] != 0 ||
        instance.to_world[3][3] != 1)
      return "a transform that is not affine";
    if (!(std::abs(instance.to_world.determinant()) > 0)) return "a transform without inverse";
  }
  for (const Camera& camera : scene.cameras)
    if (!finite(camera.to_world) || !(camera.yfov_rad > 0 && camera.yfov_rad < pi) || !(camera.ymag_m > 0) ||
        !(camera.near_m >= 0 && camera.near_m < camera.far_m))
      return "camera";
  for (const PunctualLight& light : scene.lights)
    if (const std::string fault = std::visit(CheckLight{}, light); !fault.empty()) return "light: " + fault;
  const Box3f box = bounds(scene);
  if (!scene.instances.empty() && (box.isEmpty() || !finite(box.min) || !finite(box.max))) return "bounds";
  if (scene.content_hash.size() != 16) return "content hash";
  return "";
}

}  // namespace ivory
