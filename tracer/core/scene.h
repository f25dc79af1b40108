// The scene as plain data: arrays and integer handles, in glTF's own units and conventions.
// Filled by load_gltf() (tracer/gltf/loader.h) or by hand; read by everything that traces.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "grid/base/types.h"
#include "grid/env/latlong_map.h"

namespace ivory {

inline constexpr int no_index = -1;

// An 8-bit RGBA image as stored in the file; whether its colour is sRGB depends on who samples it.
struct Image {
  std::string name;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  // height x width x 4, top row first
};

enum class Wrap { repeat, mirrored_repeat, clamp_to_edge };

struct Texture {
  int image = no_index;
  Wrap wrap_s = Wrap::repeat;
  Wrap wrap_t = Wrap::repeat;
  bool nearest = false;  // magnification filter; otherwise bilinear
};

// A material's use of a texture. KHR_texture_transform is folded into the 2x3 uv_transform:
// u' = m[0] u + m[1] v + m[2], v' = m[3] u + m[4] v + m[5].
struct TextureUse {
  int texture = no_index;
  int uv_set = 0;
  std::array<float, 6> uv_transform{1, 0, 0, 0, 1, 0};
};

enum class AlphaMode { opaque, mask, blend };

// One lobe of Lafortune et al.'s reflectance model (1997): f = k max(cx wx vx + cy wy vy + cz wz vz, 0)^exponent in
// the frame (tangent, bitangent, normal). c = (-1, -1, 1) is a mirror direction.
struct LafortuneLobe {
  Rgb k{0, 0, 0};  // 1/sr
  V3f c{-1, -1, 1};
  float exponent = 0;
  bool tinted = false;  // k is multiplied by the base colour
};
inline constexpr std::size_t max_lafortune_lobes = 7;

// glTF's metallic-roughness model with KHR_materials_specular, _ior, _emissive_strength and _transmission, or,
// where the file uses KHR_materials_pbrSpecularGlossiness, that model (specular_glossiness true).
struct Material {
  std::string name;

  Rgb base_color{1, 1, 1};  // metallic-roughness base colour, or the diffuse factor
  float alpha = 1;
  TextureUse base_color_texture;  // sRGB colour, linear alpha

  float metallic = 1;
  float roughness = 1;
  TextureUse metallic_roughness_texture;  // linear: G roughness, B metallic

  float ior = 1.5F;
  float specular = 1;                 // KHR_materials_specular; 0 makes a dielectric purely Lambertian
  TextureUse specular_texture;        // linear, A
  Rgb specular_color{1, 1, 1};        // KHR_materials_specular, or the specular factor of specular-glossiness
  TextureUse specular_color_texture;  // sRGB; specular-glossiness: RGB specular, A glossiness

  bool specular_glossiness = false;
  float glossiness = 1;

  // KHR_materials_transmission as coverage: this share of the light passes straight through, neither bent nor
  // tinted; metals and materials that emit transmit nothing.
  float transmission = 0;
  TextureUse transmission_texture;  // linear, R

  Rgb emission{0, 0, 0};        // radiance in nits, emissive strength included
  TextureUse emission_texture;  // sRGB

  TextureUse normal_texture;  // linear, tangent space
  float normal_scale = 1;

  // extras.ivory_lafortune: replaces the specular lobe where reflectance is made of cosine lobes.
  std::vector<LafortuneLobe> lafortune;

  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5F;
  bool double_sided = false;
};

// Every use of a texture that a material has, to walk over all alike: (material.*slot).texture.
inline constexpr TextureUse Material::*texture_slots[] = {
    &Material::base_color_texture,     &Material::metallic_roughness_texture, &Material::specular_texture,
    &Material::specular_color_texture, &Material::transmission_texture,       &Material::emission_texture,
    &Material::normal_texture};

// May light pass through some of it: can coverage_at() (tracer/core/surface.h) be below 1?
bool has_coverage(const Material& material);
// Does it let light through by KHR_materials_transmission? Materials that emit do not.
bool transmits(const Material& material);

// One glTF primitive as triangles. All arrays but positions and triangles may be empty; those
// that are not have one entry a vertex.
struct Mesh {
  std::string name;
  std::vector<V3f> positions;
  std::vector<V3f> normals;
  std::vector<V4f> tangents;          // w is the sign of the bitangent
  std::vector<std::vector<V2f>> uvs;  // [uv set][vertex]
  std::vector<V4f> colors;            // linear RGBA, multiplies the base colour
  std::vector<Imath::Vec3<std::uint32_t>> triangles;
  int material = no_index;  // always valid in a loaded scene; the loader adds a default material
};

// A placed mesh. Points are Imath row vectors: p_world = p * to_world. A triangle's front is where its
// corners run counter-clockwise in the mesh's own space; where the determinant is negative (a mirror)
// they run clockwise in world space, so the world normal is cross(e1, e2) times the determinant's sign.
struct Instance {
  int mesh = no_index;
  M44f to_world;
  int node = no_index;  // the scene's node that placed it
};

// A node of the file; its transform is already part of what it places.
struct SceneNode {
  std::string name;
  int parent = no_index;
  std::string fiv_table;    // extras.ivory_occluder: the FIV table of what hangs below; empty: none
  std::string light_group;  // extras.ivory_group: of the lights that hang below; empty: none of its own
};

struct Camera {
  std::string name;
  M44f to_world;  // looks along its local -Z, +Y up
  bool perspective = true;
  float yfov_rad = 0.8F;  // perspective
  float ymag_m = 1;       // orthographic half height
  // What lies nearer or farther along the direction it looks in is not seen.
  float near_m = 0;
  float far_m = std::numeric_limits<float>::infinity();
};

struct PointLight {
  V3f position;
  Rgb intensity_cd;
};
struct SpotLight {
  V3f position;
  V3f direction;  // unit, the way the light shines
  Rgb intensity_cd;
  float inner_angle_rad = 0;       // up to the outer angle: a hard edge
  float outer_angle_rad = pi / 4;  // above 0, up to pi / 2
};
struct DirectionalLight {
  V3f direction;  // unit, the way the light travels
  Rgb illuminance_lux;
};
using PunctualLight = std::variant<PointLight, SpotLight, DirectionalLight>;

// A sphere that emits the same radiance everywhere and in all directions. Rays meet it as a mesh: see
// add_sphere_light() (tracer/lights/sphere.h).
struct SphereLight {
  V3f center;  // world
  float radius_m = 0;
  Rgb radiance_nits;
  int instance = no_index;  // of that mesh
};

struct Scene {
  std::string name;  // the file it came from
  std::vector<Image> images;
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<SceneNode> nodes;
  std::vector<Camera> cameras;
  std::vector<PunctualLight> lights;
  std::vector<int> light_nodes;  // [light] the node that placed it; empty in a scene without nodes
  std::vector<SphereLight> sphere_lights;
  std::optional<EnvironmentMap> environment;
  std::string content_hash;  // of the file and everything it refers to, hexadecimal
  // Every position of the scene is local: it plus this is the world's, metres (grid/base/anchor.h). Zero near the
  // world's origin.
  V3d anchor_m{0, 0, 0};
};

// Local bounds of all instances in metres; an empty box for a scene without triangles.
Box3f bounds(const Scene& scene);

}  // namespace ivory
