#include "grid/io/export/gltf_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include "grid/base/error.h"
#include "grid/export/dialect.h"
#include "grid/io/file.h"
#include "grid/io/json.h"
#include "grid/io/ktx/bytes.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

constexpr const char* extension_name = "EXT_lights_image_based";

// A picture of one colour as PNG, 8 bits RGBA: some hundred bytes, so that no image library is asked.
std::string png_of_colour(int size, const std::array<std::uint8_t, 4>& rgba) {
  const auto put_big = [](std::string& out, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) out.push_back(char(value >> unsigned(shift) & 0xFFU));
  };
  std::string png("\x89PNG\r\n\x1A\n", 8);
  const auto chunk = [&](const std::string& type, const std::string& data) {
    put_big(png, std::uint32_t(data.size()));
    const std::string checked = type + data;
    png += checked;
    put_big(png, std::uint32_t(crc32(0, reinterpret_cast<const Bytef*>(checked.data()), uInt(checked.size()))));
  };
  std::string header;
  put_big(header, std::uint32_t(size));
  put_big(header, std::uint32_t(size));
  header += std::string("\x08\x06\x00\x00\x00", 5);  // 8 bits, RGBA, no interlacing
  chunk("IHDR", header);
  std::string rows;
  for (int row = 0; row < size; ++row) {
    rows.push_back('\0');  // no filter
    for (int column = 0; column < size; ++column)
      for (const std::uint8_t value : rgba) rows.push_back(char(value));
  }
  uLongf bytes = compressBound(uLong(rows.size()));
  std::string data(bytes, '\0');
  compress(reinterpret_cast<Bytef*>(data.data()), &bytes, reinterpret_cast<const Bytef*>(rows.data()),
           uLong(rows.size()));
  data.resize(bytes);
  chunk("IDAT", data);
  chunk("IEND", "");
  return png;
}

// The extension's images are RGBD: colour times D, of gamma 2.2, and D = a / 255 (Babylon.js' toRGBD()).
std::array<std::uint8_t, 4> rgbd(const Rgb& colour) {
  const float most = std::max(max_component(colour), 1e-7F);
  const float d = std::clamp(std::floor(std::max(255 / most, 1.0F)), 1.0F, 255.0F) / 255;
  const auto channel = [&](float c) {
    return std::uint8_t(std::lround(255 * std::pow(std::clamp(c * d, 0.0F, 1.0F), 1 / 2.2F)));
  };
  return {channel(colour.x), channel(colour.y), channel(colour.z), std::uint8_t(std::lround(255 * d))};
}

std::string base64(const std::string& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8U | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : 0U);
    for (unsigned k = 0; k < 4; ++k) out.push_back(i + k <= bytes.size() ? digits[word >> (18 - 6 * k) & 63U] : '=');
  }
  return out;
}

// A folder's path as the beginning of a URI.
std::string uri_prefix(const fs::path& folder) {
  if (folder.empty() || folder == ".") return {};
  std::string out;
  for (const char c : folder.generic_string() + "/") {
    const bool plain =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string("-._~/").find(c) != std::string::npos;
    if (plain) {
      out.push_back(c);
    } else {
      out += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
  return out;
}

void move_uris(Json& document, const std::string& prefix) {
  if (prefix.empty()) return;
  for (const char* list : {"buffers", "images"}) {
    if (!document.contains(list) || !document[list].is_array()) continue;
    for (Json& entry : document[list]) {
      if (!entry.is_object() || !entry.contains("uri") || !entry["uri"].is_string()) continue;
      const auto uri = entry["uri"].get<std::string>();
      if (uri.find(':') == std::string::npos && !uri.starts_with('/')) entry["uri"] = prefix + uri;
    }
  }
}

Json& object_at(Json& parent, const char* key) {
  if (!parent.contains(key) || !parent[key].is_object()) parent[key] = Json::object();
  return parent[key];
}
Json& list_at(Json& parent, const char* key) {
  if (!parent.contains(key) || !parent[key].is_array()) parent[key] = Json::array();
  return parent[key];
}

void add_light(Json& document, const DistantLight& light) {
  Json& images = list_at(document, "images");
  // The coarser of two levels is the one for roughness 1. Babylon.js takes log2 of the size: it must not be 0.
  constexpr int size = 2;
  Json levels = Json::array();
  for (int side = size; side >= 1; side /= 2) {
    images.push_back({{"name", fmt::format("ivory: mean light, {0}x{0}, RGBD", side)},
                      {"uri", "data:image/png;base64," + base64(png_of_colour(side, rgbd(mean_radiance(light))))}});
    const std::size_t image = images.size() - 1;
    levels.push_back({image, image, image, image, image, image});
  }
  Json coefficients = Json::array();
  for (const V3d& v : in_dialect(light.sh, Sh9Dialect::ext_lights_image_based)) coefficients.push_back({v.x, v.y, v.z});
  Json& lights = list_at(object_at(object_at(document, "extensions"), extension_name), "lights");
  lights.push_back({{"name", "ivory"},
                    {"intensity", 1},
                    {"rotation", {0, 0, 0, 1}},
                    {"irradianceCoefficients", coefficients},
                    {"specularImageSize", size},
                    {"specularImages", levels},
                    {"extras",
                     {{"generator", std::string("ivory ") + IVORY_VERSION},
                      {"basis",
                       "signs + - + - + - + - + and x mirrored, as Babylon.js in its default, left-handed scene reads "
                       "it; specularImages hold the mean light only"}}}});
  const std::size_t index = lights.size() - 1;
  Json& scenes = list_at(document, "scenes");
  if (scenes.empty()) scenes.push_back(Json::object());
  for (Json& scene : scenes) object_at(scene, "extensions")[extension_name] = {{"light", index}};
  Json& used = list_at(document, "extensionsUsed");
  if (std::find(used.begin(), used.end(), extension_name) == used.end()) used.push_back(extension_name);
}

constexpr std::uint32_t glb_magic = 0x46546C67;
constexpr std::uint32_t json_chunk = 0x4E4F534A;

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (unsigned i = 0; i < 4; ++i) word |= std::uint32_t(std::uint8_t(bytes[at + i])) << (8 * i);
  return word;
}

}  // namespace

void write_gltf_with_light(const std::string& path, const std::string& scene, const DistantLight& light, bool force) {
  std::ifstream file(scene, std::ios::binary);
  std::error_code unreadable;
  if (!file || fs::is_directory(scene, unreadable)) throw Error(scene, "cannot be read", "check the name");
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  const bool binary = bytes.size() >= 20 && word_at(bytes, 0) == glb_magic;
  std::size_t json_bytes = bytes.size();
  if (binary) {
    json_bytes = word_at(bytes, 12);
    if (word_at(bytes, 16) != json_chunk || json_bytes > bytes.size() - 20)
      throw Error(scene, "is a damaged .glb file", "export it again");
  }
  Json document = Json::parse(binary ? bytes.substr(20, json_bytes) : bytes, nullptr, /*allow_exceptions=*/false);
  if (!document.is_object() || !document.contains("asset"))
    throw Error(scene, "is no glTF scene", "name a .gltf or .glb");
  const fs::path from = fs::absolute(scene).parent_path();
  const fs::path to = fs::absolute(path).parent_path();
  move_uris(document, uri_prefix(fs::relative(from, to, unreadable)));
  add_light(document, light);
  if (!binary) {
    write_file(path, document.dump(2) + '\n', force);
    return;
  }
  std::string json = document.dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string out;
  const std::string rest = bytes.substr(20 + json_bytes);
  for (const std::uint32_t word :
       {glb_magic, 2U, std::uint32_t(20 + json.size() + rest.size()), std::uint32_t(json.size()), json_chunk})
    put(out, word);
  write_file(path, out + json + rest, force);
}

}  // namespace ivory
