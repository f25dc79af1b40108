#include <set>
#include <string_view>

#include <nlohmann/json.hpp>

#include "tracer/gltf/schema.h"

namespace ivory::gltf {
namespace {

using nlohmann::json;

constexpr std::string_view understood[] = {
    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression",
    "EXT_texture_webp",        "KHR_draco_mesh_compression",
    "KHR_lights_punctual",     "KHR_materials_emissive_strength",
    "KHR_materials_ior",       "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_specular",  "KHR_materials_transmission",
    "KHR_materials_unlit",     "KHR_mesh_quantization",
    "KHR_node_visibility",     "KHR_texture_transform",
};
// Extensions without influence on what ivory computes: nothing is lost, nothing to warn of.
constexpr std::string_view harmless[] = {"KHR_xmp", "KHR_xmp_json_ld", "KHR_animation_pointer",
                                         "KHR_materials_variants"};

bool contains(std::span<const std::string_view> list, std::string_view name) {
  for (const std::string_view entry : list)
    if (entry == name) return true;
  return false;
}

// Names of all extensions that objects of the file carry.
void collect_extensions(const json& value, std::set<std::string>& names) {
  if (value.is_object()) {
    const auto extensions = value.find("extensions");
    if (extensions != value.end() && extensions->is_object())
      for (const auto& [name, extension] : extensions->items()) names.insert(name);
    for (const auto& [key, child] : value.items())
      if (child.is_structured() && key != "extras") collect_extensions(child, names);
  } else {
    for (const json& child : value)
      if (child.is_structured()) collect_extensions(child, names);
  }
}

}  // namespace

void check_extensions(Document& document) {
  const json& root_object = *document.json;
  std::set<std::string> declared;
  for (const json& name : root_object.value("extensionsUsed", json::array())) declared.insert(name.get<std::string>());
  for (const json& name : root_object.value("extensionsRequired", json::array())) {
    if (!contains(understood, name.get<std::string>()) && !contains(harmless, name.get<std::string>()))
      document.fail("needs the extension " + name.get<std::string>() + ", which ivory does not know",
                    "export the file without it");
    declared.insert(name.get<std::string>());
  }
  std::set<std::string> present;
  collect_extensions(root_object, present);
  for (const std::string& name : present)
    if (!declared.contains(name)) document.warn("extension " + name + " is used but not declared");
  present.insert(declared.begin(), declared.end());
  for (const std::string& name : present)
    if (!contains(understood, name) && !contains(harmless, name)) document.warn("extension " + name + " is ignored");
}

}  // namespace ivory::gltf
