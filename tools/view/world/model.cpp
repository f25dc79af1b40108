#include "tools/view/world/model.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>

namespace ivory {

namespace {

gl::Wrap runtime_wrap(Wrap wrap) {
  switch (wrap) {
    case Wrap::repeat:
      return gl::Wrap::repeat;
    case Wrap::mirrored_repeat:
      return gl::Wrap::mirror;
    case Wrap::clamp_to_edge:
      return gl::Wrap::clamp;
  }
  return gl::Wrap::repeat;
}

class TextureStore {
 public:
  explicit TextureStore(const Scene& scene) : scene_(scene) {}

  // All that the materials use, before any of them points to one.
  void want(const TextureUse& use, bool srgb) {
    if (has(use)) wanted_.emplace(use.texture, srgb);
  }
  void make() {
    textures_.reserve(wanted_.size());
    for (const auto& [handle, srgb] : wanted_) {
      const Texture& texture = scene_.textures[std::size_t(handle)];
      const Image& image = scene_.images[std::size_t(texture.image)];
      index_[{handle, srgb}] = textures_.size();
      textures_.push_back(gl::make_texture_2d(scene_.name, srgb ? gl::Format::srgb8_alpha8 : gl::Format::rgba8,
                                              image.width, image.height, image.rgba.data(),
                                              texture.nearest ? gl::Filter::nearest : gl::Filter::linear_mipmap,
                                              runtime_wrap(texture.wrap_s), runtime_wrap(texture.wrap_t)));
    }
  }
  MaterialTexture at(const TextureUse& use, bool srgb) const {
    if (!has(use)) return {};
    return {&textures_[index_.at({use.texture, srgb})], use.uv_set, use.uv_transform};
  }
  std::vector<gl::Texture> take() { return std::move(textures_); }

 private:
  bool has(const TextureUse& use) const {
    if (use.texture == no_index || use.uv_set > 1) return false;
    const int image = scene_.textures[std::size_t(use.texture)].image;
    return image != no_index && !scene_.images[std::size_t(image)].rgba.empty();
  }

  const Scene& scene_;
  std::set<std::pair<int, bool>> wanted_;
  std::map<std::pair<int, bool>, std::size_t> index_;
  std::vector<gl::Texture> textures_;
};

const TextureUse& surface_use(const Material& m) {
  return m.specular_glossiness ? m.specular_color_texture : m.metallic_roughness_texture;
}

SurfaceMaterial make_material(const Material& m, const TextureStore& textures) {
  SurfaceMaterial out;
  out.base_color = m.base_color;
  // Glass is blended; its textures of transmission and of metal are not looked at.
  const float opaque = transmits(m) ? 1 - m.transmission * (1 - m.metallic) : 1;
  out.alpha = (m.alpha_mode == AlphaMode::opaque ? 1 : m.alpha) * opaque;
  out.base_color_texture = textures.at(m.base_color_texture, true);
  out.coverage = m.alpha_mode == AlphaMode::blend || opaque < 1 ? Coverage::blend
                 : m.alpha_mode == AlphaMode::mask              ? Coverage::mask
                                                                : Coverage::opaque;
  out.alpha_cutoff = m.alpha_cutoff;
  out.double_sided = m.double_sided;
  out.specular_glossiness = m.specular_glossiness;
  out.surface_texture = textures.at(surface_use(m), m.specular_glossiness);
  if (m.specular_glossiness) {
    out.dielectric_f0 = m.specular_color;
    out.roughness = 1 - m.glossiness;
  } else {
    // As tracer/core/surface.cpp: min(((ior - 1) / (ior + 1))^2 specularColor, 1) specular, and specular at grazing
    // incidence.
    const float r = (m.ior - 1) / (m.ior + 1);
    for (unsigned c = 0; c < 3; ++c) out.dielectric_f0[c] = std::min(r * r * m.specular_color[c], 1.0F) * m.specular;
    out.dielectric_f90 = m.specular;
    out.metallic = m.metallic;
    out.roughness = m.roughness;
  }
  out.normal_texture = textures.at(m.normal_texture, false);
  out.normal_scale = m.normal_scale;
  out.emission = m.emission;
  out.emission_texture = textures.at(m.emission_texture, true);
  return out;
}

MeshData mesh_data(const Mesh& mesh) {
  MeshData data;
  data.positions = mesh.positions;
  data.normals = mesh.normals;
  data.tangents = mesh.tangents;
  if (!mesh.uvs.empty()) data.uv0 = mesh.uvs[0];
  if (mesh.uvs.size() > 1) data.uv1 = mesh.uvs[1];
  data.colors = mesh.colors;
  data.triangles = mesh.triangles;
  return data;
}

void note_left_out(const Scene& scene, const std::set<int>& materials, std::vector<std::string>& notes) {
  bool specular = false;
  bool uv_sets = false;
  bool glossy = false;
  bool lafortune = false;
  for (const int index : materials) {
    const Material& m = scene.materials[std::size_t(index)];
    specular = specular || (!m.specular_glossiness &&
                            (m.specular_texture.texture != no_index || m.specular_color_texture.texture != no_index));
    for (const TextureUse* use : {&m.base_color_texture, &surface_use(m), &m.normal_texture, &m.emission_texture})
      uv_sets = uv_sets || (use->texture != no_index && use->uv_set > 1);
    glossy = glossy || (m.specular_glossiness ? !is_black(m.specular_color) : m.metallic > 0 || m.specular > 0);
    lafortune = lafortune || !m.lafortune.empty();
  }
  if (specular) notes.push_back(fmt::format("{}: textures of KHR_materials_specular are left out", scene.name));
  if (uv_sets) notes.push_back(fmt::format("{}: textures of a third set of coordinates are left out", scene.name));
  if (lafortune)
    notes.push_back(fmt::format("{}: Lafortune lobes are left out: their materials reflect as glTF's say", scene.name));
  if (glossy) {
    notes.push_back(
        fmt::format("{}: what glossy surfaces reflect of indirect light is left out, and lights with extent are "
                    "reflected as blurred as their pieces are large",
                    scene.name));
  }
}

}  // namespace

std::size_t GpuModel::bytes() const {
  std::size_t sum = 0;
  for (const GpuMesh& mesh : meshes) sum += mesh.bytes();
  for (const gl::Texture& texture : textures) sum += texture.bytes();
  return sum;
}

GpuModel upload(const Scene& scene) {
  GpuModel model;
  std::map<int, std::size_t> meshes;
  std::map<int, std::size_t> materials;
  std::set<int> used;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    if (meshes.emplace(instance.mesh, model.meshes.size()).second)
      model.meshes.push_back(upload(mesh_data(mesh), scene.name));
    used.insert(mesh.material);
  }
  TextureStore textures(scene);
  for (const int index : used) {
    const Material& m = scene.materials[std::size_t(index)];
    textures.want(m.base_color_texture, true);
    textures.want(surface_use(m), m.specular_glossiness);
    textures.want(m.normal_texture, false);
    textures.want(m.emission_texture, true);
  }
  textures.make();
  for (const int index : used) {
    materials[index] = model.materials.size();
    model.materials.push_back(make_material(scene.materials[std::size_t(index)], textures));
  }
  model.textures = textures.take();  // a moved vector keeps its elements where they are
  for (const Instance& instance : scene.instances) {
    model.parts.push_back(
        {meshes.at(instance.mesh), materials.at(scene.meshes[std::size_t(instance.mesh)].material), instance.to_world});
  }
  note_left_out(scene, used, model.left_out);
  return model;
}

namespace {

bool same_layout(const Scene& a, const Scene& b) {
  const auto same_mesh = [](const Mesh& m, const Mesh& n) {
    return m.positions.size() == n.positions.size() && m.triangles == n.triangles &&
           m.normals.size() == n.normals.size() && m.tangents.size() == n.tangents.size() && m.material == n.material;
  };
  return std::equal(a.instances.begin(), a.instances.end(), b.instances.begin(), b.instances.end(),
                    [](const Instance& i, const Instance& k) { return i.mesh == k.mesh; }) &&
         std::equal(a.meshes.begin(), a.meshes.end(), b.meshes.begin(), b.meshes.end(), same_mesh) &&
         a.materials.size() == b.materials.size();
}

}  // namespace

void update(GpuModel& model, const Scene& before, const Scene& scene) {
  if (!same_layout(before, scene) || model.parts.size() != scene.instances.size()) {
    model = upload(scene);
    return;
  }
  std::set<int> done;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    const int index = scene.instances[i].mesh;
    model.parts[i].to_world = scene.instances[i].to_world;
    if (!done.insert(index).second) continue;
    const Mesh& was = before.meshes[std::size_t(index)];
    const Mesh& mesh = scene.meshes[std::size_t(index)];
    if (was.positions != mesh.positions || was.normals != mesh.normals || was.tangents != mesh.tangents)
      update(model.meshes[model.parts[i].mesh], mesh_data(mesh), scene.name);
  }
}

std::vector<RuntimeLight> runtime_lights(const Scene& scene) {
  std::vector<RuntimeLight> lights;
  for (const PunctualLight& light : scene.lights) {
    RuntimeLight out;
    std::visit(
        [&](const auto& l) {
          using T = std::decay_t<decltype(l)>;
          if constexpr (std::is_same_v<T, DirectionalLight>) {
            out.kind = LightKind::directional;
            out.direction = l.direction;
            out.intensity = l.illuminance_lux;
          } else {
            out.position_m = l.position;
            out.intensity = l.intensity_cd;
            if constexpr (std::is_same_v<T, SpotLight>) {
              out.kind = LightKind::spot;
              out.direction = l.direction;
              out.inner_angle_rad = l.inner_angle_rad;
              out.outer_angle_rad = l.outer_angle_rad;
            }
          }
        },
        light);
    lights.push_back(out);
  }
  return lights;
}

std::vector<RuntimeLight> strongest(const std::vector<RuntimeLight>& lights, std::size_t count, const V3f& center_m,
                                    float radius_m) {
  if (lights.size() <= count) return lights;
  // Illuminance at a distance that is usual in the scene: what a lamp does right beside it says little of the picture.
  const auto illuminance = [&](std::size_t i) {
    const RuntimeLight& light = lights[i];
    if (light.kind == LightKind::directional) return luminance(light.intensity);
    const float distance_m = std::max((light.position_m - center_m).length(), radius_m);
    return luminance(light.intensity) / (distance_m * distance_m);
  };
  std::vector<std::size_t> order(lights.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return illuminance(a) > illuminance(b); });
  order.resize(count);
  std::sort(order.begin(), order.end());
  std::vector<RuntimeLight> kept;
  kept.reserve(order.size());
  for (const std::size_t i : order) kept.push_back(lights[i]);
  return kept;
}

}  // namespace ivory
