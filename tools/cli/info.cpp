// ivory info: what a file holds and how it was made.
#include <algorithm>
#include <memory>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/io/difmap.h"
#include "grid/io/exr.h"
#include "grid/io/image_info.h"
#include "grid/io/json.h"
#include "grid/io/sh9.h"
#include "grid/io/sphere_set.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/cli/scene_info.h"
#include "tools/cli/target_error.h"
#include "tools/input/file_kind.h"
#include "tools/input/scene.h"
#include "tools/input/vdb/load.h"

namespace ivory {

namespace {

template <typename Vector>
Json vector_json(const Vector& v) {
  return {shortest(v.x), shortest(v.y), shortest(v.z)};
}

// Vectors and lists come as text from the file.
Json vdb_json(const std::string& path) {
  Json json = to_json(load_vdb_info(path));
  for (auto& [key, value] : json.items()) {
    if (key == "size" || key == "origin_m" || key == "anchor_m" || key == "spacing_m" || key.starts_with("axis_")) {
      Json list = Json::parse(value.get<std::string>(), nullptr, /*allow_exceptions=*/false);
      if (list.is_array()) value = std::move(list);
    }
  }
  Json names = Json::array();
  std::istringstream list(json["grids"].get<std::string>());
  for (std::string name; list >> name;) names.push_back(name);
  json["grids"] = std::move(names);
  return json;
}

Json exr_asset_json(const std::string& path, const std::string& kind) {
  const ExrAsset asset = read_exr(path, kind, "bake it again");
  Json json{{"kind", kind}, {"width", asset.width}, {"height", asset.height}, {"channels", asset.channels}};
  json.update(to_json(asset.metadata));
  for (const auto& [key, list] : asset.lists) {
    for (const float value : list) json[key].push_back(shortest(value));
  }
  return json;
}

Json spheres_json(const std::string& path) {
  const SphereSet set = read_spheres(path);
  Json json{{"kind", "spheres"}, {"spheres", set.spheres.size()}};
  Box3f box;
  float smallest = set.spheres.front().radius_m;
  float largest = 0;
  for (const Sphere& s : set.spheres) {
    const V3f r(s.radius_m, s.radius_m, s.radius_m);
    box.extendBy(s.center - r);
    box.extendBy(s.center + r);
    smallest = std::min(smallest, s.radius_m);
    largest = std::max(largest, s.radius_m);
  }
  json["radius_min_m"] = shortest(smallest);
  json["radius_max_m"] = shortest(largest);
  json["bounds_min_m"] = shortest(box.min, set.anchor_m);
  json["bounds_max_m"] = shortest(box.max, set.anchor_m);
  json.update(to_json(set.metadata));
  return json;
}

Json sh9_json(const std::string& path) {
  const Sh9Asset asset = read_sh9(path);
  Json json{{"kind", "sh9"},
            {"order", asset.order},
            {"window", {1, asset.window.band1, asset.window.band2}},
            {"average_error", asset.error.average},
            {"maximum_error", asset.error.maximum},
            {"average_error_of_mean_irradiance", asset.error.average_of_mean_e()},
            {"maximum_error_of_mean_irradiance", asset.error.maximum_of_mean_e()}};
  json.update(to_json(asset.metadata));
  Json coefficients = Json::array();
  for (const V3d& rgb : asset.sh.coefficients) coefficients.push_back({rgb.x, rgb.y, rgb.z});
  json["coefficients"] = std::move(coefficients);
  return json;
}

Json difmap_json(const std::string& path) {
  const DifMap map = read_difmap(path);
  Json json{{"kind", "difmap"}};
  json.update(to_json(map.metadata));
  Rgb least = map.e.texels.front();
  Rgb greatest = least;
  for (const Rgb& e : map.e.texels) {
    for (unsigned c = 0; c < 3; ++c) {
      least[c] = std::min(least[c], e[c]);
      greatest[c] = std::max(greatest[c], e[c]);
    }
  }
  json["least_irradiance_lux"] = vector_json(least);
  json["greatest_irradiance_lux"] = vector_json(greatest);
  return json;
}

// What an asset says of its own error, as one object in place of the entries that files keep.
void gather_certificate(Json& json) {
  Metadata metadata;
  for (const auto& [key, value] : json.items()) {
    if (!key.starts_with("certificate_")) continue;
    if (value.is_number()) metadata[key] = value.get<double>();
    if (value.is_string()) metadata[key] = value.get<std::string>();
  }
  const std::optional<Certificate> certificate = find_certificate(metadata);
  if (!certificate) return;
  Json object = certificate_json(*certificate);
  if (const auto worst = find_text(metadata, "certificate_worst")) {
    object["worst"] = Json::array();
    std::istringstream lines(*worst);
    for (std::string line; std::getline(lines, line);) object["worst"].push_back(line);
  }
  for (const auto& [key, value] : metadata) json.erase(key);
  json["certificate"] = std::move(object);
}

std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string text;
  for (const Json& item : value) text += (text.empty() ? "" : " ") + text_of(item);
  return text;
}

// "point, 12 10 8 cd, 151 126 101 lm at 0 2.5 1"
std::string light_text(const Json& light) {
  std::string text = light["type"].get<std::string>();
  for (const auto& [key, value] : light.items()) {
    const std::size_t unit = key.rfind('_');
    if (key == "type" || unit == std::string::npos) continue;
    text += key == "position_m" ? " at " + text_of(value) : ", " + text_of(value) + " " + key.substr(unit + 1);
  }
  return text;
}

// Its lines, each behind the word.
std::string certificate_lines(const Json& json) {
  Certificate certificate{json.value("target", 0.0),  json["error"].get<double>(),        json["low"].get<double>(),
                          json["high"].get<double>(), json["measure"].get<std::string>(), {}};
  for (const auto& [name, part] : json["parts"].items()) certificate.parts[name] = part.get<double>();
  std::string text;
  std::istringstream lines(certificate_text(certificate));
  for (std::string line; std::getline(lines, line);) text += fmt::format("{:<20} {}\n", "certificate", line);
  if (json.contains("worst")) {
    for (const Json& line : json["worst"]) text += fmt::format("{:<20} {}\n", "worst", line.get<std::string>());
  }
  return text;
}

void run_info(const std::string& path, const SceneOptions& options, const CommonOptions& common) {
  Json json{{"file", path}};
  if (options.load.scale != 1 && file_kind(path) != FileKind::scene) throw UsageError("--scale serves scenes only");
  switch (const FileKind kind = file_kind(path)) {
    case FileKind::scene:
      json.update(scene_info(path, options, common));
      break;
    case FileKind::grid:
      json.update(vdb_json(path));
      break;
    case FileKind::sh9:
      json.update(sh9_json(path));
      break;
    case FileKind::difmap:
      json.update(difmap_json(path));
      break;
    case FileKind::spheres:
      json.update(spheres_json(path));
      break;
    case FileKind::fiv:
    case FileKind::cubemap:
    case FileKind::lobes:
      json.update(exr_asset_json(path, std::string(name_of(kind))));
      break;
    case FileKind::image:
      json["kind"] = "image";
      json.update(to_json(read_image_info(path)));
      break;
  }
  // Assets keep them as lines of one text.
  if (const auto assumptions = json.find("assumptions"); assumptions != json.end() && assumptions->is_string()) {
    std::istringstream lines(assumptions->get<std::string>());
    *assumptions = Json::array();
    for (std::string line; std::getline(lines, line);) assumptions->push_back(line);
  }
  gather_certificate(json);
  std::string text;
  for (const auto& [key, value] : json.items()) {
    if (key == "certificate") {
      text += certificate_lines(value);
    } else if (key == "lights") {
      constexpr std::size_t most = 20;
      for (std::size_t i = 0; i < std::min(most, value.size()); ++i)
        text += fmt::format("{:<20} {}\n", "light", light_text(value[i]));
      if (value.size() > most) text += fmt::format("{:<20} {} more; --json lists all\n", "light", value.size() - most);
    } else if (key == "warnings" || key == "hints" || key == "assumptions") {
      for (const Json& line : value) text += fmt::format("{:<20} {}\n", key.substr(0, key.size() - 1), text_of(line));
    } else if (value.is_array() && value.size() > 60) {
      text += fmt::format("{:<20} {} of them; --json lists all\n", key, value.size());
    } else {
      text += fmt::format("{:<20} {}\n", key, text_of(value));
    }
  }
  print_result(common, json, text);
}

}  // namespace

void add_info_command(Command app, CommonOptions& common) {
  Command command = app.add_subcommand("info", "What a file holds and how it was made: assets, parts, scenes, images");
  auto path = std::make_shared<std::string>();
  auto options = std::make_shared<SceneOptions>();
  command.add_option("file", *path, "File: .vdb, .gltf, .glb, a baked .exr or .json, or an image")
      .required()
      .type_name("FILE");
  add_scene_options(command, *options);
  command.footer(
      "Lengths are in metres, powers in lumen (R G B), irradiance in lux.\n"
      "\nExamples:\n"
      "  ivory info room.vdb\n"
      "  ivory info room.glb --json");
  set_action(command, common, Output::none, [path, options, &common] { run_info(*path, *options, common); });
}

}  // namespace ivory
