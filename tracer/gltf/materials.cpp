#include "tracer/gltf/materials.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tracer/gltf/extras.h"

namespace ivory::gltf {
namespace {

using nlohmann::json;

const json* member(const json* object, const char* name) {
  if (object == nullptr) return nullptr;
  const auto found = object->find(name);
  return found == object->end() ? nullptr : &*found;
}

float number(const json* object, const char* name, float fallback) {
  const json* value = member(object, name);
  return value == nullptr ? fallback : value->get<float>();
}

Rgb color(const json* object, const char* name, const Rgb& fallback) {
  const json* value = member(object, name);
  return value == nullptr ? fallback : Rgb((*value)[0], (*value)[1], (*value)[2]);
}

TextureUse make_texture_use(const json* info) {
  TextureUse use;
  if (info == nullptr) return use;
  use.texture = (*info)["index"];
  use.uv_set = info->value("texCoord", 0);
  if (const json* transform = find_extension(*info, "KHR_texture_transform")) {
    use.uv_set = transform->value("texCoord", use.uv_set);
    const float angle = number(transform, "rotation", 0);
    const json* offset = member(transform, "offset");
    const json* scale = member(transform, "scale");
    const float sx = scale == nullptr ? 1 : (*scale)[0].get<float>();
    const float sy = scale == nullptr ? 1 : (*scale)[1].get<float>();
    const float s = std::sin(angle);
    const float c = std::cos(angle);
    // Offset * Rotation * Scale. v points down, so that the counter-clockwise turn of the text is
    // (c, s; -s, c): what Khronos' TextureTransformTest asks for, and the transpose of the matrix
    // printed in the extension's text.
    use.uv_transform = {c * sx,  s * sy, offset == nullptr ? 0 : (*offset)[0].get<float>(),
                        -s * sx, c * sy, offset == nullptr ? 0 : (*offset)[1].get<float>()};
  }
  return use;
}

Material make_material(Document& document, std::size_t index) {
  const json& source = element(document, "materials", index);
  const tinygltf::Material& parsed = document.model.materials[index];
  const std::string what = label("materials", index, parsed.name);

  Material material;
  material.name = parsed.name;
  const auto& factor = parsed.pbrMetallicRoughness.baseColorFactor;
  material.base_color = Rgb(float(factor[0]), float(factor[1]), float(factor[2]));
  material.alpha = float(factor[3]);
  material.metallic = float(parsed.pbrMetallicRoughness.metallicFactor);
  material.roughness = float(parsed.pbrMetallicRoughness.roughnessFactor);
  const json* metallic_roughness = member(&source, "pbrMetallicRoughness");
  material.base_color_texture = make_texture_use(member(metallic_roughness, "baseColorTexture"));
  material.metallic_roughness_texture = make_texture_use(member(metallic_roughness, "metallicRoughnessTexture"));

  material.normal_texture = make_texture_use(member(&source, "normalTexture"));
  material.normal_scale = float(parsed.normalTexture.scale);

  material.emission_texture = make_texture_use(member(&source, "emissiveTexture"));
  const auto& emission = parsed.emissiveFactor;
  material.emission = Rgb(float(emission[0]), float(emission[1]), float(emission[2]));
  if (max_component(material.emission) > 1)
    document.warn(what + " has an emissive factor above 1, which glTF does not allow; taken as it stands, in nits");
  material.emission *= number(find_extension(source, "KHR_materials_emissive_strength"), "emissiveStrength", 1);

  if (parsed.alphaMode == "MASK") material.alpha_mode = AlphaMode::mask;
  if (parsed.alphaMode == "BLEND") material.alpha_mode = AlphaMode::blend;
  material.alpha_cutoff = float(parsed.alphaCutoff);
  material.double_sided = parsed.doubleSided;
  material.lafortune = read_lafortune(document, index);

  if (const json* extension = find_extension(source, "KHR_materials_pbrSpecularGlossiness")) {
    material.specular_glossiness = true;
    material.base_color = color(extension, "diffuseFactor", {1, 1, 1});
    const json* diffuse = member(extension, "diffuseFactor");
    material.alpha = diffuse == nullptr ? 1 : (*diffuse)[3].get<float>();
    material.base_color_texture = make_texture_use(member(extension, "diffuseTexture"));
    material.specular_color = color(extension, "specularFactor", {1, 1, 1});
    material.specular_color_texture = make_texture_use(member(extension, "specularGlossinessTexture"));
    material.glossiness = number(extension, "glossinessFactor", 1);
    return material;
  }

  if (const json* extension = find_extension(source, "KHR_materials_specular")) {
    material.specular = number(extension, "specularFactor", 1);
    material.specular_texture = make_texture_use(member(extension, "specularTexture"));
    material.specular_color = color(extension, "specularColorFactor", {1, 1, 1});
    material.specular_color_texture = make_texture_use(member(extension, "specularColorTexture"));
  }
  if (const json* extension = find_extension(source, "KHR_materials_transmission")) {
    material.transmission = number(extension, "transmissionFactor", 0);
    material.transmission_texture = make_texture_use(member(extension, "transmissionTexture"));
  }
  material.ior = number(find_extension(source, "KHR_materials_ior"), "ior", 1.5F);
  // 0 is the extension's way to say "Fresnel term of one".
  if (material.ior != 0 && material.ior < 1)
    document.fail(fmt::format("{} has an index of refraction of {}", what, material.ior), "use 0, or 1 and above");
  return material;
}

Wrap make_wrap(int wrap) {
  if (wrap == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::clamp_to_edge;
  if (wrap == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Wrap::mirrored_repeat;
  return Wrap::repeat;
}

}  // namespace

std::vector<Material> make_materials(Document& document) {
  std::vector<Material> materials;
  materials.reserve(document.model.materials.size() + 1);
  for (std::size_t i = 0; i < document.model.materials.size(); ++i) materials.push_back(make_material(document, i));
  const auto glass = std::find_if(materials.begin(), materials.end(), transmits);
  if (glass != materials.end()) {
    document.warn(
        fmt::format("{}: glass (KHR_materials_transmission) lets light straight through, without refraction "
                    "and tint",
                    label("materials", std::size_t(glass - materials.begin()), glass->name)));
  }
  for (std::size_t i = 0; i < materials.size(); ++i) {
    if (materials[i].transmission > 0 && !is_black(materials[i].emission))
      document.warn(label("materials", i, materials[i].name) + " emits and transmits light; it is taken as opaque");
  }
  materials.emplace_back().name = "default";
  return materials;
}

bool is_unlit(const Document& document, int material) {
  return material >= 0 &&
         find_extension(element(document, "materials", std::size_t(material)), "KHR_materials_unlit") != nullptr;
}

std::vector<Texture> make_textures(Document& document) {
  std::vector<Texture> textures;
  for (std::size_t i = 0; i < document.model.textures.size(); ++i) {
    const tinygltf::Texture& source = document.model.textures[i];
    Texture texture;
    texture.image = source.source;
    if (const json* webp = find_extension(element(document, "textures", i), "EXT_texture_webp"))
      texture.image = webp->value("source", texture.image);
    if (source.sampler >= 0) {
      const tinygltf::Sampler& sampler = document.model.samplers[std::size_t(source.sampler)];
      texture.wrap_s = make_wrap(sampler.wrapS);
      texture.wrap_t = make_wrap(sampler.wrapT);
      texture.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    textures.push_back(texture);
  }
  return textures;
}

}  // namespace ivory::gltf
