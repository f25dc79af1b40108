#include "tracer/gltf_schema.h"

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace ivory::gltf {
namespace {

using nlohmann::json;

enum class Kind {
  string,
  boolean,
  number,
  integer,
  numbers,
  index,
  indices,
  index_map,
  index_maps,
  object,
  objects,
  one_of,
  strings
};

constexpr double unbounded = std::numeric_limits<double>::infinity();
// Everything ends up as a float, with room for a few products.
constexpr double float_limit = 1e30;
constexpr double byte_limit = 1e15;

struct Field;
using Schema = std::span<const Field>;

struct Field {
  const char* name;
  Kind kind;
  bool required = false;
  // Range of numbers, or of array lengths for indices and objects.
  double minimum = -float_limit;
  double maximum = float_limit;
  std::size_t length = 0;        // of `numbers`; 0 for any
  const char* target = nullptr;  // index, indices, index_map: the array pointed into
  Schema schema{};               // object, objects
  std::string_view one_of{};     // allowed strings or integers, separated by blanks
  bool exclusive_minimum = false;
};

constexpr bool required = true;
constexpr bool optional = false;

constexpr Field texture_transform[] = {
    {"offset", Kind::numbers, optional, -float_limit, float_limit, 2},
    {"rotation", Kind::number},
    {"scale", Kind::numbers, optional, -float_limit, float_limit, 2},
    {"texCoord", Kind::integer, optional, 0, 31},
};
constexpr Field texture_info_extensions[] = {
    {.name = "KHR_texture_transform", .kind = Kind::object, .schema = texture_transform}};
constexpr Field texture_info[] = {
    {.name = "index", .kind = Kind::index, .required = required, .target = "textures"},
    {"texCoord", Kind::integer, optional, 0, 31},
    {.name = "extensions", .kind = Kind::object, .schema = texture_info_extensions},
};
constexpr Field normal_texture_info[] = {
    {.name = "index", .kind = Kind::index, .required = required, .target = "textures"},
    {"texCoord", Kind::integer, optional, 0, 31},
    {"scale", Kind::number},
    {.name = "extensions", .kind = Kind::object, .schema = texture_info_extensions},
};

constexpr Field metallic_roughness[] = {
    {"baseColorFactor", Kind::numbers, optional, 0, 1, 4},
    {.name = "baseColorTexture", .kind = Kind::object, .schema = texture_info},
    {"metallicFactor", Kind::number, optional, 0, 1},
    {"roughnessFactor", Kind::number, optional, 0, 1},
    {.name = "metallicRoughnessTexture", .kind = Kind::object, .schema = texture_info},
};
constexpr Field specular_glossiness[] = {
    {"diffuseFactor", Kind::numbers, optional, 0, 1, 4},
    {.name = "diffuseTexture", .kind = Kind::object, .schema = texture_info},
    {"specularFactor", Kind::numbers, optional, 0, 1, 3},
    {"glossinessFactor", Kind::number, optional, 0, 1},
    {.name = "specularGlossinessTexture", .kind = Kind::object, .schema = texture_info},
};
constexpr Field specular[] = {
    {"specularFactor", Kind::number, optional, 0, 1},
    {.name = "specularTexture", .kind = Kind::object, .schema = texture_info},
    {"specularColorFactor", Kind::numbers, optional, 0, float_limit, 3},
    {.name = "specularColorTexture", .kind = Kind::object, .schema = texture_info},
};
constexpr Field ior[] = {{"ior", Kind::number, optional, 0, float_limit}};
constexpr Field emissive_strength[] = {{"emissiveStrength", Kind::number, optional, 0, float_limit}};
constexpr Field empty_schema[] = {{"", Kind::string}};
constexpr Field material_extensions[] = {
    {.name = "KHR_materials_pbrSpecularGlossiness", .kind = Kind::object, .schema = specular_glossiness},
    {.name = "KHR_materials_specular", .kind = Kind::object, .schema = specular},
    {.name = "KHR_materials_ior", .kind = Kind::object, .schema = ior},
    {.name = "KHR_materials_emissive_strength", .kind = Kind::object, .schema = emissive_strength},
    {.name = "KHR_materials_unlit", .kind = Kind::object, .schema = empty_schema},
};
constexpr Field material[] = {
    {"name", Kind::string},
    {.name = "pbrMetallicRoughness", .kind = Kind::object, .schema = metallic_roughness},
    {.name = "normalTexture", .kind = Kind::object, .schema = normal_texture_info},
    {.name = "occlusionTexture", .kind = Kind::object, .schema = texture_info},
    {.name = "emissiveTexture", .kind = Kind::object, .schema = texture_info},
    {"emissiveFactor", Kind::numbers, optional, 0, float_limit, 3},
    {.name = "alphaMode", .kind = Kind::one_of, .one_of = "OPAQUE MASK BLEND"},
    {"alphaCutoff", Kind::number, optional, 0, float_limit},
    {"doubleSided", Kind::boolean},
    {.name = "extensions", .kind = Kind::object, .schema = material_extensions},
};

constexpr Field sparse_indices[] = {
    {.name = "bufferView", .kind = Kind::index, .required = required, .target = "bufferViews"},
    {"byteOffset", Kind::integer, optional, 0, 2147483647},
    {.name = "componentType", .kind = Kind::one_of, .required = required, .one_of = "5121 5123 5125"},
};
constexpr Field sparse_values[] = {
    {.name = "bufferView", .kind = Kind::index, .required = required, .target = "bufferViews"},
    {"byteOffset", Kind::integer, optional, 0, 2147483647},
};
constexpr Field sparse[] = {
    {"count", Kind::integer, required, 1, 2147483647},
    {.name = "indices", .kind = Kind::object, .required = required, .schema = sparse_indices},
    {.name = "values", .kind = Kind::object, .required = required, .schema = sparse_values},
};
constexpr Field accessor[] = {
    {"name", Kind::string},
    {.name = "bufferView", .kind = Kind::index, .target = "bufferViews"},
    {"byteOffset", Kind::integer, optional, 0, byte_limit},
    {.name = "componentType", .kind = Kind::one_of, .required = required, .one_of = "5120 5121 5122 5123 5125 5126"},
    {"normalized", Kind::boolean},
    {"count", Kind::integer, required, 1, 2147483647},
    {.name = "type", .kind = Kind::one_of, .required = required, .one_of = "SCALAR VEC2 VEC3 VEC4 MAT2 MAT3 MAT4"},
    {.name = "sparse", .kind = Kind::object, .schema = sparse},
};
constexpr Field meshopt[] = {
    {.name = "buffer", .kind = Kind::index, .required = required, .target = "buffers"},
    {"byteOffset", Kind::integer, optional, 0, byte_limit},
    {"byteLength", Kind::integer, required, 1, byte_limit},
    {"byteStride", Kind::integer, required, 1, 256},
    {"count", Kind::integer, required, 1, 2147483647},
    {.name = "mode", .kind = Kind::one_of, .required = required, .one_of = "ATTRIBUTES TRIANGLES INDICES"},
    {.name = "filter", .kind = Kind::one_of, .one_of = "NONE OCTAHEDRAL QUATERNION EXPONENTIAL"},
};
constexpr Field buffer_view_extensions[] = {
    {.name = "EXT_meshopt_compression", .kind = Kind::object, .schema = meshopt}};
constexpr Field buffer_view[] = {
    {.name = "buffer", .kind = Kind::index, .required = required, .target = "buffers"},
    {"byteOffset", Kind::integer, optional, 0, byte_limit},
    {"byteLength", Kind::integer, required, 1, byte_limit},
    {"byteStride", Kind::integer, optional, 4, 252},
    {.name = "extensions", .kind = Kind::object, .schema = buffer_view_extensions},
};
constexpr Field meshopt_buffer[] = {{"fallback", Kind::boolean}};
constexpr Field buffer_extensions[] = {
    {.name = "EXT_meshopt_compression", .kind = Kind::object, .schema = meshopt_buffer}};
constexpr Field buffer[] = {
    {"uri", Kind::string},
    {"byteLength", Kind::integer, required, 1, byte_limit},
    {.name = "extensions", .kind = Kind::object, .schema = buffer_extensions},
};

constexpr Field draco[] = {
    {.name = "bufferView", .kind = Kind::index, .required = required, .target = "bufferViews"},
    {.name = "attributes", .kind = Kind::index_map, .required = required},
};
constexpr Field primitive_extensions[] = {
    {.name = "KHR_draco_mesh_compression", .kind = Kind::object, .schema = draco}};
constexpr Field primitive[] = {
    {.name = "attributes", .kind = Kind::index_map, .required = required, .target = "accessors"},
    {.name = "indices", .kind = Kind::index, .target = "accessors"},
    {.name = "material", .kind = Kind::index, .target = "materials"},
    {"mode", Kind::integer, optional, 0, 6},
    {.name = "targets", .kind = Kind::index_maps, .target = "accessors"},
    {.name = "extensions", .kind = Kind::object, .schema = primitive_extensions},
};
constexpr Field mesh[] = {
    {"name", Kind::string},
    {.name = "primitives",
     .kind = Kind::objects,
     .required = required,
     .minimum = 1,
     .maximum = unbounded,
     .schema = primitive},
    {.name = "weights", .kind = Kind::numbers},
};

constexpr Field instancing[] = {
    {.name = "attributes", .kind = Kind::index_map, .required = required, .target = "accessors"}};
constexpr Field node_light[] = {{.name = "light", .kind = Kind::index, .required = required, .target = "lights"}};
constexpr Field node_visibility[] = {{"visible", Kind::boolean}};
constexpr Field node_extensions[] = {
    {.name = "EXT_mesh_gpu_instancing", .kind = Kind::object, .schema = instancing},
    {.name = "KHR_lights_punctual", .kind = Kind::object, .schema = node_light},
    {.name = "KHR_node_visibility", .kind = Kind::object, .schema = node_visibility},
};
constexpr Field node[] = {
    {"name", Kind::string},
    {.name = "camera", .kind = Kind::index, .target = "cameras"},
    {.name = "children", .kind = Kind::indices, .target = "nodes"},
    {.name = "mesh", .kind = Kind::index, .target = "meshes"},
    {"matrix", Kind::numbers, optional, -float_limit, float_limit, 16},
    {"rotation", Kind::numbers, optional, -1.01, 1.01, 4},
    {"scale", Kind::numbers, optional, -float_limit, float_limit, 3},
    {"translation", Kind::numbers, optional, -float_limit, float_limit, 3},
    {.name = "weights", .kind = Kind::numbers},
    {.name = "extensions", .kind = Kind::object, .schema = node_extensions},
};
constexpr Field scene[] = {
    {"name", Kind::string},
    {.name = "nodes", .kind = Kind::indices, .target = "nodes"},
};

constexpr Field webp[] = {{.name = "source", .kind = Kind::index, .target = "images"}};
constexpr Field texture_extensions[] = {{.name = "EXT_texture_webp", .kind = Kind::object, .schema = webp}};
constexpr Field texture[] = {
    {.name = "sampler", .kind = Kind::index, .target = "samplers"},
    {.name = "source", .kind = Kind::index, .target = "images"},
    {.name = "extensions", .kind = Kind::object, .schema = texture_extensions},
};
constexpr Field sampler[] = {
    {.name = "magFilter", .kind = Kind::one_of, .one_of = "9728 9729"},
    {.name = "minFilter", .kind = Kind::one_of, .one_of = "9728 9729 9984 9985 9986 9987"},
    {.name = "wrapS", .kind = Kind::one_of, .one_of = "33071 33648 10497"},
    {.name = "wrapT", .kind = Kind::one_of, .one_of = "33071 33648 10497"},
};
constexpr Field image[] = {
    {"name", Kind::string},
    {"uri", Kind::string},
    {"mimeType", Kind::string},
    {.name = "bufferView", .kind = Kind::index, .target = "bufferViews"},
};

constexpr Field perspective[] = {
    {.name = "yfov",
     .kind = Kind::number,
     .required = required,
     .minimum = 0,
     .maximum = 3.1415926,
     .exclusive_minimum = true},
    {.name = "aspectRatio", .kind = Kind::number, .minimum = 0, .exclusive_minimum = true},
    {.name = "znear", .kind = Kind::number, .required = required, .minimum = 0, .exclusive_minimum = true},
    {.name = "zfar", .kind = Kind::number, .minimum = 0, .exclusive_minimum = true},
};
constexpr Field orthographic[] = {
    {.name = "xmag", .kind = Kind::number, .required = required, .minimum = 0, .exclusive_minimum = true},
    {.name = "ymag", .kind = Kind::number, .required = required, .minimum = 0, .exclusive_minimum = true},
    {.name = "znear", .kind = Kind::number, .required = required, .minimum = 0},
    {.name = "zfar", .kind = Kind::number, .required = required, .minimum = 0, .exclusive_minimum = true},
};
constexpr Field camera[] = {
    {"name", Kind::string},
    {.name = "type", .kind = Kind::one_of, .required = required, .one_of = "perspective orthographic"},
    {.name = "perspective", .kind = Kind::object, .schema = perspective},
    {.name = "orthographic", .kind = Kind::object, .schema = orthographic},
};

constexpr Field spot[] = {
    {"innerConeAngle", Kind::number, optional, 0, 1.5707964},
    {"outerConeAngle", Kind::number, optional, 0, 1.5707964},
};
constexpr Field light[] = {
    {"name", Kind::string},
    {.name = "type", .kind = Kind::string, .required = required},
    {"color", Kind::numbers, optional, 0, float_limit, 3},
    {"intensity", Kind::number, optional, 0, float_limit},
    {.name = "range", .kind = Kind::number, .minimum = 0, .exclusive_minimum = true},
    {.name = "spot", .kind = Kind::object, .schema = spot},
};
constexpr Field lights[] = {{.name = "lights", .kind = Kind::objects, .required = required, .schema = light}};
constexpr Field root_extensions[] = {{.name = "KHR_lights_punctual", .kind = Kind::object, .schema = lights}};

constexpr Field asset[] = {
    {.name = "version", .kind = Kind::string, .required = required},
    {"minVersion", Kind::string},
};
constexpr Field root[] = {
    {.name = "asset", .kind = Kind::object, .required = required, .schema = asset},
    {.name = "extensionsUsed", .kind = Kind::strings},
    {.name = "extensionsRequired", .kind = Kind::strings},
    {.name = "accessors", .kind = Kind::objects, .schema = accessor},
    {.name = "bufferViews", .kind = Kind::objects, .schema = buffer_view},
    {.name = "buffers", .kind = Kind::objects, .schema = buffer},
    {.name = "cameras", .kind = Kind::objects, .schema = camera},
    {.name = "images", .kind = Kind::objects, .schema = image},
    {.name = "materials", .kind = Kind::objects, .schema = material},
    {.name = "meshes", .kind = Kind::objects, .schema = mesh},
    {.name = "nodes", .kind = Kind::objects, .schema = node},
    {.name = "samplers", .kind = Kind::objects, .schema = sampler},
    {.name = "scene", .kind = Kind::index, .target = "scenes"},
    {.name = "scenes", .kind = Kind::objects, .schema = scene},
    {.name = "textures", .kind = Kind::objects, .schema = texture},
    {.name = "extensions", .kind = Kind::object, .schema = root_extensions},
};

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
  static constexpr const char* remedy = "export the file again, or check it with the Khronos glTF validator";

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
        if (field.length != 0 && value.size() != field.length)
          document_.fail(fmt::format("{} has {} numbers instead of {}", place.text(), value.size(), field.length),
                         remedy);
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
    if (!(x >= 0 && x < size))
      document_.fail(target == nullptr
                         ? fmt::format("{} is {}, out of range", place.text(), x)
                         : fmt::format("{} points to {}[{}], which does not exist", place.text(), target, x),
                     remedy);
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

constexpr std::string_view understood[] = {
    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression",
    "EXT_texture_webp",        "KHR_draco_mesh_compression",
    "KHR_lights_punctual",     "KHR_materials_emissive_strength",
    "KHR_materials_ior",       "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_specular",  "KHR_materials_unlit",
    "KHR_mesh_quantization",   "KHR_node_visibility",
    "KHR_texture_transform",
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

// What no table of single properties can say.
void check_pairs(const Document& document) {
  constexpr const char* remedy = "export the file again, or check it with the Khronos glTF validator";
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
    if (entry["type"] == "spot") {
      if (!entry.contains("spot")) document.fail(fmt::format("lights[{}] is a spot light without spot", index), remedy);
      const json& spot_entry = entry["spot"];
      if (!(spot_entry.value("innerConeAngle", 0.0) < spot_entry.value("outerConeAngle", 0.7853981633974483)))
        document.fail(fmt::format("lights[{}] has an inner cone that is not smaller than its outer cone", index),
                      remedy);
    }
    ++index;
  }
}

}  // namespace

void check_schema(Document& document) {
  Checker(document).object(*document.json, root, Place{});
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
  if (minimum != "2.0")
    document.fail("asset.minVersion asks for glTF " + minimum,
                  "ivory reads glTF 2.0; export the file for that version");
}

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
