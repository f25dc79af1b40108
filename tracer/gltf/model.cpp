// Hands the checked JSON to tinygltf. Buffers and images are read by ivory (tinygltf trusts the
// views that images name, and knows neither meshopt's placeholder buffers nor accessors without a
// view as indices), so they and everything that ivory does not need are left out.
#include <nlohmann/json.hpp>

#include "tracer/gltf/document.h"

namespace ivory::gltf {
namespace {

using nlohmann::json;

void drop_extras(json& value) {
  if (value.is_object()) {
    value.erase("extensions");
    value.erase("extras");
  }
  if (value.is_structured())
    for (json& child : value) drop_extras(child);
}

}  // namespace

void parse_model(Document& document) {
  json copy = json::object();
  for (const char* name : {"asset", "accessors", "bufferViews", "cameras", "materials", "meshes", "nodes", "samplers",
                           "scene", "scenes", "textures"}) {
    const auto found = document.json->find(name);
    if (found != document.json->end()) copy[name] = *found;
  }
  drop_extras(copy);
  // tinygltf wants a view for every accessor of indices.
  const int no_view = copy.contains("bufferViews") ? int(copy["bufferViews"].size()) : 0;
  copy["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 1}});
  if (copy.contains("accessors"))
    for (json& accessor : copy["accessors"])
      if (!accessor.contains("bufferView")) accessor["bufferView"] = no_view;

  const std::string text = copy.dump();
  tinygltf::TinyGLTF parser;
  std::string errors;
  std::string warnings;
  bool parsed = false;
  if (text.size() < (std::size_t{1} << 31U)) {
    try {
      parsed = parser.LoadASCIIFromString(&document.model, &errors, &warnings, text.data(), unsigned(text.size()), "");
    } catch (const std::exception& error) {
      errors += error.what();
    }
  }
  if (!parsed) document.fail("cannot be understood: " + errors, "export it again");
  document.model.bufferViews.pop_back();
  for (tinygltf::Accessor& accessor : document.model.accessors)
    if (accessor.bufferView == no_view) accessor.bufferView = -1;
}

}  // namespace ivory::gltf
