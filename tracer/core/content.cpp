#include "tracer/core/content.h"

#include <algorithm>
#include <map>
#include <span>
#include <type_traits>

#include <OpenImageIO/hash.h>
#include <fmt/format.h>

namespace ivory {

namespace {

// XXH64 of what is added, in order. Sizes are added with arrays, so that they cannot run into each other.
class Hasher {
 public:
  template <typename T>
  Hasher& add(const T& value) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>,
                  "padding has no value: add the members");
    return add_bytes(&value, sizeof value);
  }
  Hasher& add(const V3f& v) { return add(v.x).add(v.y).add(v.z); }
  Hasher& add(const Rgb& c) { return add(c.x).add(c.y).add(c.z); }
  Hasher& add(const V3d& v) { return add(v.x).add(v.y).add(v.z); }
  Hasher& add(const M44f& m) { return add_bytes(&m.x, sizeof m.x); }
  Hasher& add(const std::string& text) { return add(text.size()).add_bytes(text.data(), text.size()); }
  // Of numbers without padding: vectors of floats or whole numbers.
  template <typename T>
  Hasher& add_all(const std::vector<T>& values) {
    return add(values.size()).add_bytes(values.data(), values.size() * sizeof(T));
  }
  std::uint64_t value() const { return hash_; }

 private:
  Hasher& add_bytes(const void* data, std::size_t size) {
    hash_ = OIIO::xxhash::XXH64(data, size, hash_);
    return *this;
  }
  std::uint64_t hash_ = 0;
};

class Parts {
 public:
  explicit Parts(const Scene& scene) : scene_(scene), images_(scene.images.size(), 0) {
    for (std::size_t i = 0; i < scene.images.size(); ++i) {
      const Image& image = scene.images[i];
      images_[i] = Hasher().add(image.width).add(image.height).add_all(image.rgba).value();
    }
  }

  std::vector<ContentPart> make() {
    add_meshes();
    add_instances();
    for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
      const int node = i < scene_.light_nodes.size() ? scene_.light_nodes[i] : no_index;
      add(ContentKind::light, "light", node_name(node), light_hash(scene_.lights[i]));
    }
    for (const SphereLight& light : scene_.sphere_lights) {
      const int node = light.instance == no_index ? no_index : scene_.instances[std::size_t(light.instance)].node;
      add(ContentKind::light, "spherical light", node_name(node),
          Hasher().add(light.center).add(light.radius_m).add(light.radiance_nits).value());
    }
    for (const Camera& camera : scene_.cameras) {
      add(ContentKind::camera, "camera", camera.name,
          Hasher()
              .add(camera.name)
              .add(camera.to_world)
              .add(camera.perspective)
              .add(camera.yfov_rad)
              .add(camera.ymag_m)
              .add(camera.near_m)
              .add(camera.far_m)
              .value());
    }
    Hasher names;
    for (const SceneNode& node : scene_.nodes)
      names.add(node.name).add(node.parent).add(node.fiv_table).add(node.light_group);
    add(ContentKind::name, "names of nodes", "", names.value());
    add(ContentKind::shape, "place in the world", "", Hasher().add(scene_.anchor_m).value());
    return std::move(parts_);
  }

 private:
  void add(ContentKind kind, const std::string& what, const std::string& name, std::uint64_t hash) {
    std::string label = name.empty() ? what : fmt::format("{} '{}'", what, name);
    const int seen = ++seen_[std::string(name_of(kind)) + label];
    if (seen > 1) label += fmt::format(" ({})", seen);
    parts_.push_back({kind, std::move(label), hash});
  }

  std::string node_name(int node) const {
    for (; node != no_index; node = scene_.nodes[std::size_t(node)].parent) {
      const std::string& name = scene_.nodes[std::size_t(node)].name;
      if (!name.empty()) return name;
    }
    return {};
  }

  void add_texture(Hasher& hasher, const TextureUse& use) const {
    if (use.texture == no_index) {
      hasher.add(no_index);
      return;
    }
    const Texture& texture = scene_.textures[std::size_t(use.texture)];
    hasher.add(texture.image == no_index ? std::uint64_t{0} : images_[std::size_t(texture.image)]);
    hasher.add(int(texture.wrap_s)).add(int(texture.wrap_t)).add(texture.nearest).add(use.uv_set);
    for (const float m : use.uv_transform) hasher.add(m);
  }

  // What lets light through.
  std::uint64_t coverage_hash(const Material& m) const {
    Hasher hasher;
    hasher.add(int(m.alpha_mode)).add(m.double_sided);
    if (!has_coverage(m)) return hasher.value();
    hasher.add(m.alpha).add(m.alpha_cutoff).add(m.transmission).add(m.metallic).add(m.emission);
    add_texture(hasher, m.base_color_texture);
    add_texture(hasher, m.transmission_texture);
    return hasher.value();
  }

  std::uint64_t look_hash(const Material& m) const {
    Hasher hasher;
    hasher.add(m.base_color).add(m.metallic).add(m.roughness).add(m.ior).add(m.specular).add(m.specular_color);
    hasher.add(m.specular_glossiness).add(m.glossiness).add(m.normal_scale);
    for (const auto slot : {&Material::base_color_texture, &Material::metallic_roughness_texture,
                            &Material::specular_texture, &Material::specular_color_texture, &Material::normal_texture})
      add_texture(hasher, m.*slot);
    for (const LafortuneLobe& lobe : m.lafortune) hasher.add(lobe.k).add(lobe.c).add(lobe.exponent).add(lobe.tinted);
    return hasher.value();
  }

  void add_meshes() {
    std::vector<bool> mesh_used(scene_.meshes.size(), false);
    std::vector<bool> material_used(scene_.materials.size(), false);
    for (const Instance& instance : scene_.instances) {
      mesh_used[std::size_t(instance.mesh)] = true;
      material_used[std::size_t(scene_.meshes[std::size_t(instance.mesh)].material)] = true;
    }
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
      if (!material_used[i]) continue;
      const Material& m = scene_.materials[i];
      add(ContentKind::shape, "coverage of material", m.name, coverage_hash(m));
      add(ContentKind::look, "material", m.name, look_hash(m));
      if (m.emission == Rgb(0, 0, 0)) continue;
      Hasher emission;
      emission.add(m.emission);
      add_texture(emission, m.emission_texture);
      add(ContentKind::light, "emission of material", m.name, emission.value());
    }
    shapes_.resize(scene_.meshes.size());
    looks_.resize(scene_.meshes.size());
    for (std::size_t i = 0; i < scene_.meshes.size(); ++i) {
      if (!mesh_used[i]) continue;
      const Mesh& mesh = scene_.meshes[i];
      Hasher shape;
      shape.add_all(mesh.positions).add_all(mesh.triangles);
      Hasher look;
      look.add_all(mesh.normals).add_all(mesh.tangents).add_all(mesh.colors).add(mesh.uvs.size());
      for (const auto& uvs : mesh.uvs) look.add_all(uvs);
      // Where it is not whole, coordinates and colours say where.
      if (has_coverage(scene_.materials[std::size_t(mesh.material)])) shape.add(look.value());
      shapes_[i] = shape.value();
      looks_[i] = look.value();
      add(ContentKind::shape, "mesh", mesh.name, shapes_[i]);
      add(ContentKind::look, "normals and coordinates of mesh", mesh.name, looks_[i]);
    }
  }

  // Which mesh of which material stands where. A mesh and its material are told by what they are.
  void add_instances() {
    for (const Instance& instance : scene_.instances) {
      const auto mesh = std::size_t(instance.mesh);
      const Material& m = scene_.materials[std::size_t(scene_.meshes[mesh].material)];
      add(ContentKind::shape, "object", node_name(instance.node),
          Hasher().add(shapes_[mesh]).add(coverage_hash(m)).add(instance.to_world).value());
      add(ContentKind::look, "material of object", node_name(instance.node),
          Hasher().add(looks_[mesh]).add(look_hash(m)).value());
      // Emissive objects shine from where they stand.
      if (m.emission != Rgb(0, 0, 0)) {
        add(ContentKind::light, "lamp", node_name(instance.node),
            Hasher().add(shapes_[mesh]).add(m.emission).add(instance.to_world).value());
      }
    }
  }

  static std::uint64_t light_hash(const PunctualLight& light) {
    Hasher hasher;
    hasher.add(light.index());
    if (const auto* point = std::get_if<PointLight>(&light)) hasher.add(point->position).add(point->intensity_cd);
    if (const auto* spot = std::get_if<SpotLight>(&light)) {
      hasher.add(spot->position).add(spot->direction).add(spot->intensity_cd);
      hasher.add(spot->inner_angle_rad).add(spot->outer_angle_rad);
    }
    if (const auto* sun = std::get_if<DirectionalLight>(&light)) hasher.add(sun->direction).add(sun->illuminance_lux);
    return hasher.value();
  }

  const Scene& scene_;
  std::vector<std::uint64_t> images_;
  std::vector<std::uint64_t> shapes_;  // [mesh]
  std::vector<std::uint64_t> looks_;
  std::map<std::string, int> seen_;
  std::vector<ContentPart> parts_;
};

}  // namespace

std::vector<ContentPart> content_parts(const Scene& scene) { return Parts(scene).make(); }

std::uint64_t hash_of(std::span<const ContentPart> parts) {
  Hasher hasher;
  for (const ContentPart& part : parts) hasher.add(part.hash);
  return hasher.value();
}

}  // namespace ivory
