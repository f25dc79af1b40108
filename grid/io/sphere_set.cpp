#include "grid/io/sphere_set.h"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/io/file.h"
#include "grid/io/json.h"

namespace ivory {

namespace {

constexpr const char* remedy = json_spheres.remedy;

// The shortest text that reads back as the same float.
std::string text_of(float value) { return fmt::format("{}", value); }

}  // namespace

void write_spheres(const std::string& path, const SphereSet& set, bool force) {
  Json json{{json_spheres.key, json_spheres.value}, {"format_version", json_format_version}, {"units", "metres"}};
  json.update(to_json(set.metadata));
  std::string text = json.dump(1);
  // One sphere a line, floats as short as they read back the same.
  text.resize(text.find_last_of('}'));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  text += ",\n \"spheres\": [\n";
  for (std::size_t i = 0; i < set.spheres.size(); ++i) {
    const Sphere& s = set.spheres[i];
    const V3d center = to_world(s.center, set.anchor_m);
    const auto coordinate = [&](int axis) {
      return set.anchor_m[axis] == 0 ? text_of(s.center[axis]) : fmt::format("{}", center[axis]);
    };
    text += fmt::format("  [{}, {}, {}, {}]{}\n", coordinate(0), coordinate(1), coordinate(2), text_of(s.radius_m),
                        i + 1 < set.spheres.size() ? "," : "");
  }
  text += " ]\n}\n";
  write_file(path, text, force);
}

SphereSet read_spheres(const std::string& path) {
  const Json json = read_json_asset(path, json_spheres);
  const auto list = json.find("spheres");
  if (list == json.end() || !list->is_array() || list->empty()) throw Error(path, "holds no spheres", remedy);
  if (list->size() > max_spheres) throw Error(path, fmt::format("holds more than {} spheres", max_spheres), remedy);
  SphereSet set;
  std::vector<V3d> centers;
  Imath::Box3d box;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const Json& item = (*list)[i];
    bool good = item.is_array() && item.size() == 4;
    std::array<double, 4> v{};
    for (std::size_t k = 0; good && k < 4; ++k) {
      good = item[k].is_number() && std::abs(item[k].get<double>()) <= 1e9;
      if (good) v[k] = item[k].get<double>();
    }
    if (!good || !(float(v[3]) > 0))
      throw Error(path, fmt::format("spheres[{}] is not [x, y, z, radius] in metres with a radius above 0", i), remedy);
    centers.emplace_back(v[0], v[1], v[2]);
    box.extendBy(centers.back() - V3d(v[3]));
    box.extendBy(centers.back() + V3d(v[3]));
    set.spheres.push_back({V3f(0, 0, 0), float(v[3])});
  }
  set.anchor_m = choose_anchor(box.center(), box.size().length() / 2);
  for (std::size_t i = 0; i < centers.size(); ++i) set.spheres[i].center = to_local(centers[i], set.anchor_m);
  set.metadata = metadata_from_json(json, json_spheres);
  return set;
}

}  // namespace ivory
