#include "tracer/gltf/schema/check.h"

#include <cmath>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tracer/gltf/schema/tables.h"

namespace ivory::gltf {
namespace {

using nlohmann::json;

// Own code: validators of JSON schemas neither follow indices into other arrays nor name the element that breaks a
// rule.

// Where the checker is, spelled out only when something is wrong.
struct Place {
  const Place* parent = nullptr;
  const char* name = nullptr;
  std::size_t index = 0;

  std::string text() const {
    std::string result = parent != nullptr ? parent->text() : "";
    if (name == nullptr) return parent == nullptr ? result : fmt::format("{}[{}]", result, index);
    if (!result.empty()) result += '.';
    return result + name;
  }
};

class Checker {
 public:
  explicit Checker(const Document& document) : document_(document) {}

  void object(json& value, Schema schema, const Place& place) const {
    if (!value.is_object()) wrong_type(place, "an object");
    for (const Field& field : schema) {
      const Place here{&place, field.name};
      const auto found = value.find(field.name);
      if (found == value.end()) {
        if (field.required) document_.fail(here.text() + " is missing", remedy);
        continue;
      }
      property(*found, field, here);
    }
  }

 private:
  void property(json& value, const Field& field, const Place& place) const {
    switch (field.kind) {
      case Kind::string:
        if (!value.is_string()) wrong_type(place, "a string");
        break;
      case Kind::boolean:
        if (!value.is_boolean()) wrong_type(place, "true or false");
        break;
      case Kind::number:
        number(value, field, place);
        break;
      case Kind::integer:
        make_integer(value, place);
        number(value, field, place);
        break;
      case Kind::numbers:
        array(value, place);
        if (field.length != 0 && value.size() != field.length) {
          document_.fail(fmt::format("{} has {} numbers instead of {}", place.text(), value.size(), field.length),
                         remedy);
        }
        for (std::size_t i = 0; i < value.size(); ++i) number(value[i], field, Place{&place, nullptr, i});
        break;
      case Kind::index:
        index(value, field.target, place);
        break;
      case Kind::indices:
        array(value, place);
        for (std::size_t i = 0; i < value.size(); ++i) index(value[i], field.target, Place{&place, nullptr, i});
        break;
      case Kind::index_map:
        index_map(value, field.target, place);
        break;
      case Kind::index_maps:
        array(value, place);
        for (std::size_t i = 0; i < value.size(); ++i) index_map(value[i], field.target, Place{&place, nullptr, i});
        break;
      case Kind::object:
        object(value, field.schema, place);
        break;
      case Kind::objects:
        array(value, place);
        if (field.minimum > 0 && double(value.size()) < field.minimum)
          document_.fail(place.text() + " is empty", remedy);
        for (std::size_t i = 0; i < value.size(); ++i) object(value[i], field.schema, Place{&place, nullptr, i});
        break;
      case Kind::one_of:
        choice(value, field.one_of, place);
        break;
      case Kind::strings:
        array(value, place);
        for (std::size_t i = 0; i < value.size(); ++i)
          if (!value[i].is_string()) wrong_type(Place{&place, nullptr, i}, "a string");
        break;
    }
  }

  void number(const json& value, const Field& field, const Place& place) const {
    if (!value.is_number()) wrong_type(place, "a number");
    const double x = value.get<double>();
    const bool low = field.exclusive_minimum ? !(x > field.minimum) : !(x >= field.minimum);
    if (low || !(x <= field.maximum)) document_.fail(fmt::format("{} is {}, out of range", place.text(), x), remedy);
  }

  // "Integers may be written as 1.0" (glTF 2.0, 2.7.1.2).
  void make_integer(json& value, const Place& place) const {
    if (value.is_number_float()) {
      const double x = value.get<double>();
      if (std::abs(x) < 9e15 && x == std::floor(x)) value = static_cast<std::int64_t>(x);
    }
    if (!value.is_number_integer()) wrong_type(place, "an integer");
  }

  void index(json& value, const char* target, const Place& place) const {
    make_integer(value, place);
    const double x = value.get<double>();
    const double size = target == nullptr ? 2147483647.0 : double(array_size(target));
    if (!(x >= 0 && x < size)) {
      document_.fail(target == nullptr
                         ? fmt::format("{} is {}, out of range", place.text(), x)
                         : fmt::format("{} points to {}[{}], which does not exist", place.text(), target, x),
                     remedy);
    }
  }

  void index_map(json& value, const char* target, const Place& place) const {
    if (!value.is_object()) wrong_type(place, "an object");
    for (auto& [key, entry] : value.items()) index(entry, target, Place{&place, key.c_str()});
  }

  std::size_t array_size(std::string_view target) const {
    const json* owner = document_.json.get();
    if (target == "lights") {
      owner = find_extension(*owner, "KHR_lights_punctual");
      if (owner == nullptr) return 0;
    }
    const auto found = owner->find(target);
    return found != owner->end() && found->is_array() ? found->size() : 0;
  }

  void choice(json& value, std::string_view one_of, const Place& place) const {
    if (!value.is_string()) make_integer(value, place);
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    for (std::string_view rest = one_of; !rest.empty();) {
      const std::size_t end = std::min(rest.find(' '), rest.size());
      // A number in quotes is not a number.
      if (rest.substr(0, end) == text && value.is_string() == (rest[0] >= 'A')) return;
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    document_.fail(fmt::format("{} is {}, not one of {}", place.text(), value.dump(), one_of), remedy);
  }

  void array(const json& value, const Place& place) const {
    if (!value.is_array()) wrong_type(place, "an array");
  }

  [[noreturn]] void wrong_type(const Place& place, const char* wanted) const {
    const std::string where = place.text();
    document_.fail(fmt::format("{} is not {}", where.empty() ? "the JSON document" : where, wanted), remedy);
  }

  const Document& document_;
};

// What no table of single properties can say.
void check_pairs(const Document& document) {
  const json& root_object = *document.json;
  const json none = json::array();
  const auto list = [&](const char* name) -> const json& {
    const auto found = root_object.find(name);
    return found == root_object.end() ? none : *found;
  };
  std::size_t index = 0;
  for (const json& entry : list("images")) {
    if (entry.contains("uri") == entry.contains("bufferView"))
      document.fail(fmt::format("images[{}] must have either a uri or a bufferView", index), remedy);
    ++index;
  }
  index = 0;
  for (const json& entry : list("bufferViews")) {
    const int stride = entry.value("byteStride", 4);
    if (stride % 4 != 0)
      document.fail(fmt::format("bufferViews[{}].byteStride is {}, not a multiple of 4", index, stride), remedy);
    ++index;
  }
  index = 0;
  for (const json& entry : list("skins")) {
    if (entry["joints"].empty()) document.fail(fmt::format("skins[{}] has no joints", index), remedy);
    ++index;
  }
  index = 0;
  for (const json& entry : list("cameras")) {
    const std::string type = entry["type"];
    if (!entry.contains(type)) document.fail(fmt::format("cameras[{}] has no {}", index, type), remedy);
    const json& projection = entry[type];
    if (projection.contains("zfar") && projection["zfar"].get<double>() <= projection["znear"].get<double>())
      document.fail(fmt::format("cameras[{}] has zfar before znear", index), remedy);
    ++index;
  }
  index = 0;
  const json* extension = find_extension(root_object, "KHR_lights_punctual");
  for (const json& entry : extension == nullptr ? none : (*extension)["lights"]) {
    if (entry["type"] == "spot" && !entry.contains("spot"))
      document.fail(fmt::format("lights[{}] is a spot light without spot", index), remedy);
    ++index;
  }
}

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

void check_schema(Document& document) {
  Checker(document).object(*document.json, root_schema(), Place{});
  check_pairs(document);

  const std::string version = (*document.json)["asset"]["version"];
  const json& info = (*document.json)["asset"];
  const std::string minimum = info.value("minVersion", std::string("2.0"));
  const auto is_version = [](const std::string& text) {
    return text.size() >= 3 && text.find_first_not_of("0123456789.") == std::string::npos &&
           text.find('.') != std::string::npos && text.front() != '.' && text.back() != '.';
  };
  if (!is_version(version) || version.substr(0, 2) != "2.")
    document.fail("asset.version is '" + version + "'", "ivory reads glTF 2.0; convert the file");
  if (minimum != "2.0") {
    document.fail("asset.minVersion asks for glTF " + minimum,
                  "ivory reads glTF 2.0; export the file for that version");
  }
}

void check_animation_schema(Document& document) {
  Checker(document).object(*document.json, animation_schema(), Place{});
}

void check_extensions(Document& document) {
  const json& root_object = *document.json;
  std::set<std::string> declared;
  for (const json& name : root_object.value("extensionsUsed", json::array())) declared.insert(name.get<std::string>());
  for (const json& name : root_object.value("extensionsRequired", json::array())) {
    if (!contains(understood, name.get<std::string>()) && !contains(harmless, name.get<std::string>())) {
      document.fail("needs the extension " + name.get<std::string>() + ", which ivory does not know",
                    "export the file without it");
    }
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
