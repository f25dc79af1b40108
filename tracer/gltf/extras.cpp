#include "tracer/gltf/extras.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/lobes/lobe.h"

namespace ivory::gltf {

namespace {

using nlohmann::json;

const json* extra(const json& object, const char* name) {
  const auto extras = object.find("extras");
  if (extras == object.end() || !extras->is_object()) return nullptr;
  const auto found = extras->find(name);
  return found == extras->end() ? nullptr : &*found;
}

[[noreturn]] void fail(const Document& document, const std::string& what, const char* field, const char* wanted) {
  document.fail(fmt::format("{}.{} is not {}", what, field, wanted), "correct it");
}

float number(const Document& document, const json& object, const char* name, const std::string& what, float least,
             float most) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number()) fail(document, what, name, "given as a number");
  const double value = found->get<double>();
  if (!(value >= double(least) && value <= double(most)))
    fail(document, what, name, fmt::format("from {} to {}", least, most).c_str());
  return float(value);
}

V3f triple(const Document& document, const json& object, const char* name, const std::string& what, float least) {
  const auto found = object.find(name);
  V3f v;
  if (found == object.end() || !found->is_array() || found->size() != 3) fail(document, what, name, "three numbers");
  for (unsigned i = 0; i < 3; ++i) {
    const json& item = (*found)[i];
    if (!item.is_number()) fail(document, what, name, "three numbers");
    const double value = item.get<double>();
    if (!(value >= double(least) && value < 1e30)) fail(document, what, name, "three numbers in range");
    v[i] = float(value);
  }
  return v;
}

}  // namespace

std::vector<LafortuneLobe> read_lafortune(const Document& document, std::size_t material) {
  std::vector<LafortuneLobe> lobes;
  const json& source = element(document, "materials", material);
  const json* list = extra(source, "ivory_lafortune");
  if (list == nullptr) return lobes;
  const std::string what =
      label("materials", material, source.value("name", std::string())) + ".extras.ivory_lafortune";
  if (!list->is_array() || list->empty() || list->size() > max_lafortune_lobes)
    document.fail(fmt::format("{} is not a list of 1 to {} lobes", what, max_lafortune_lobes), "correct it");
  for (std::size_t i = 0; i < list->size(); ++i) {
    const json& item = (*list)[i];
    const std::string here = fmt::format("{}[{}]", what, i);
    if (!item.is_object()) document.fail(here + " is not an object", "correct it");
    LafortuneLobe lobe;
    const V3f k = triple(document, item, "k", here, 0);
    lobe.k = Rgb(k.x, k.y, k.z);
    lobe.c = triple(document, item, "c", here, -1e30F);
    lobe.exponent = number(document, item, "exponent", here, 0, max_lobe_exponent);
    // c_max^e is the lobe's growth: beyond this its values leave float.
    const float length = std::max({std::abs(lobe.c.x), std::abs(lobe.c.y), std::abs(lobe.c.z)});
    if (length > 0 && lobe.exponent * std::log(length) > 60) fail(document, here, "c", "small enough for its exponent");
    const auto tinted = item.find("tinted");
    if (tinted != item.end()) {
      if (!tinted->is_boolean()) fail(document, here, "tinted", "true or false");
      lobe.tinted = tinted->get<bool>();
    }
    lobes.push_back(lobe);
  }
  return lobes;
}

std::optional<SphereLight> read_sphere_light(const Document& document, std::size_t node, const M44f& to_world) {
  const json& source = element(document, "nodes", node);
  const json* item = extra(source, "ivory_sphere_light");
  if (item == nullptr) return std::nullopt;
  const std::string what = label("nodes", node, source.value("name", std::string())) + ".extras.ivory_sphere_light";
  if (!item->is_object()) document.fail(what + " is not an object", "correct it");
  SphereLight light;
  const M44f& m = to_world;
  const V3f x(m[0][0], m[0][1], m[0][2]);
  const V3f y(m[1][0], m[1][1], m[1][2]);
  const V3f z(m[2][0], m[2][1], m[2][2]);
  light.center = V3f(m[3][0], m[3][1], m[3][2]);
  light.radius_m = number(document, *item, "radius", what, 1e-6F, 1e9F) * std::cbrt(std::abs(x.cross(y).dot(z)));
  const V3f radiance = triple(document, *item, "radiance", what, 0);
  light.radiance_nits = Rgb(radiance.x, radiance.y, radiance.z);
  return light;
}

namespace {

// The node's text of that name among its extras, `what` in words; empty where there is none.
std::string read_node_text(const Document& document, std::size_t node, const char* name, const char* what) {
  const json& source = element(document, "nodes", node);
  const json* text = extra(source, name);
  if (text == nullptr) return {};
  if (!text->is_string() || text->get<std::string>().empty())
    fail(document, label("nodes", node, source.value("name", std::string())) + ".extras", name, what);
  return text->get<std::string>();
}

}  // namespace

std::string read_fiv_table(const Document& document, std::size_t node) {
  const std::string table = read_node_text(document, node, "ivory_occluder", "the name of an FIV table");
  return table.empty() ? table : path_beside(document, table);
}

std::string read_light_group(const Document& document, std::size_t node) {
  return read_node_text(document, node, "ivory_group", "the name of a group of lights");
}

}  // namespace ivory::gltf
