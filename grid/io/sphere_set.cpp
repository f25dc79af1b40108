#include "grid/io/sphere_set.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/io/file.h"

namespace ivory {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* remedy = "make one with: ivory bake spheres MESH.glb -o SPHERES.json";
constexpr std::uintmax_t max_bytes = 256U << 20U;

// The shortest text that reads back as the same float.
std::string text_of(float value) { return fmt::format("{}", value); }

}  // namespace

void write_spheres(const std::string& path, const SphereSet& set, bool force) {
  PendingFile pending(path, force);
  Json json{{"ivory_asset", "spheres"}, {"format_version", 1}, {"units", "metres"}};
  for (const auto& [key, value] : set.metadata) std::visit([&, &k = key](const auto& v) { json[k] = v; }, value);
  std::string text = json.dump(1);
  // One sphere a line, floats as short as they read back the same.
  text.resize(text.find_last_of('}'));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  text += ",\n \"spheres\": [\n";
  for (std::size_t i = 0; i < set.spheres.size(); ++i) {
    const Sphere& s = set.spheres[i];
    text += fmt::format("  [{}, {}, {}, {}]{}\n", text_of(s.center.x), text_of(s.center.y), text_of(s.center.z),
                        text_of(s.radius_m), i + 1 < set.spheres.size() ? "," : "");
  }
  text += " ]\n}\n";
  std::ofstream file(pending.temporary(), std::ios::binary);
  file << text;
  file.close();
  if (!file) throw Error(path, "cannot be written", "check the disk");
  pending.commit();
}

SphereSet read_spheres(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) throw Error(path, "is a folder", remedy);
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) throw Error(path, "cannot be read", "check that it exists and is readable");
  if (bytes > max_bytes) throw Error(path, "is too large for a sphere set", remedy);
  std::ifstream file(path, std::ios::binary);
  const Json json = Json::parse(file, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded() || !json.is_object() || json.value("ivory_asset", Json()) != Json("spheres"))
    throw Error(path, "is not a sphere set", remedy);
  if (json.value("format_version", Json()) != Json(1)) throw Error(path, "is of another format version", remedy);
  const auto list = json.find("spheres");
  if (list == json.end() || !list->is_array() || list->empty()) throw Error(path, "holds no spheres", remedy);
  if (list->size() > max_spheres) throw Error(path, fmt::format("holds more than {} spheres", max_spheres), remedy);
  SphereSet set;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const Json& item = (*list)[i];
    bool good = item.is_array() && item.size() == 4;
    std::array<float, 4> v{};
    for (std::size_t k = 0; good && k < 4; ++k) {
      good = item[k].is_number() && std::abs(item[k].get<double>()) <= 1e9;
      if (good) v[k] = item[k].get<float>();
    }
    if (!good || !(v[3] > 0))
      throw Error(path, fmt::format("spheres[{}] is not [x, y, z, radius] in metres with a radius above 0", i), remedy);
    set.spheres.push_back({V3f(v[0], v[1], v[2]), v[3]});
  }
  for (const auto& [key, value] : json.items()) {
    if (key == "spheres" || key == "ivory_asset") continue;
    if (value.is_string())
      set.metadata[key] = value.get<std::string>();
    else if (value.is_number_integer())
      set.metadata[key] = value.get<std::int64_t>();
    else if (value.is_number())
      set.metadata[key] = value.get<double>();
  }
  return set;
}

bool is_sphere_set(const std::string& path) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error || bytes > max_bytes) return false;
  std::ifstream file(path, std::ios::binary);
  const Json json = Json::parse(file, nullptr, /*allow_exceptions=*/false);
  return json.is_object() && json.value("ivory_asset", Json()) == Json("spheres");
}

}  // namespace ivory
