#include "grid/io/json.h"

#include <array>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include "grid/base/error.h"

namespace ivory {

namespace {

// Reads up to the entry of the outermost object that names a kind.
class KindFinder : public nlohmann::json_sax<Json> {
 public:
  std::string kind;

  bool null() override { return true; }
  bool boolean(bool /*value*/) override { return true; }
  bool number_integer(number_integer_t /*value*/) override { return true; }
  bool number_unsigned(number_unsigned_t /*value*/) override { return true; }
  bool number_float(number_float_t /*value*/, const string_t& /*text*/) override { return true; }
  bool binary(binary_t& /*value*/) override { return true; }
  bool string(string_t& value) override {
    for (const JsonAssetKind& known : {json_sh9, json_spheres}) {
      if (depth_ == 1 && key_ == known.key && value == known.value) kind = known.name;
    }
    return kind.empty();
  }
  bool start_object(std::size_t /*size*/) override { return ++depth_ > 0; }
  bool end_object() override { return --depth_ >= 0; }
  bool start_array(std::size_t /*size*/) override { return ++depth_ > 1; }  // the outermost is an object
  bool end_array() override { return --depth_ >= 0; }
  bool key(string_t& value) override {
    if (depth_ == 1) key_ = value;
    return true;
  }
  bool parse_error(std::size_t /*at*/, const std::string& /*token*/,
                   const nlohmann::detail::exception& /*error*/) override {
    return false;
  }

 private:
  int depth_ = 0;
  std::string key_;
};

}  // namespace

Json read_json_asset(const std::string& path, const JsonAssetKind& kind) {
  const std::string what = kind.what;
  std::error_code unreadable;
  if (std::filesystem::is_directory(path, unreadable)) throw Error(path, "is a folder", "name a file");
  const std::uintmax_t bytes = std::filesystem::file_size(path, unreadable);
  std::ifstream file(path, std::ios::binary);
  if (unreadable || !file) throw Error(path, "cannot be read", "check the name");
  if (bytes > kind.largest_bytes)
    throw Error(path, "is too large (no " + what + " is above " + std::to_string(kind.largest_bytes) + " bytes)",
                kind.remedy);
  Json json = Json::parse(file, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) throw Error(path, "is not JSON", kind.remedy);
  if (!json.is_object() || json.value(kind.key, Json()) != kind.value) throw Error(path, "is no " + what, kind.remedy);
  const Json version = json.value("format_version", Json());
  if (!version.is_number()) throw Error(path, "has no format_version that is a number", kind.remedy);
  if (version != json_format_version) {
    throw Error(path,
                "has format version " + version.dump() + ", this ivory reads " + std::to_string(json_format_version),
                kind.remedy);
  }
  return json;
}

std::string json_asset_kind(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (file.peek() == std::ifstream::traits_type::eof()) return {};  // a folder too
  KindFinder finder;
  Json::sax_parse(file, &finder);
  return finder.kind;
}

Json to_json(const Metadata& metadata) {
  Json json = Json::object();
  for (const auto& [key, value] : metadata) std::visit([&, &k = key](const auto& v) { json[k] = v; }, value);
  return json;
}

Json to_json(const std::array<V3d, 9>& coefficients) {
  Json list = Json::array();
  for (const V3d& c : coefficients) list.push_back({c.x, c.y, c.z});
  return list;
}

Metadata metadata_from_json(const Json& object, const JsonAssetKind& kind) {
  Metadata metadata;
  for (const auto& [key, value] : object.items()) {
    if (value.is_string()) {
      metadata[key] = value.get<std::string>();
    } else if (value.is_number_integer()) {
      metadata[key] = value.get<std::int64_t>();
    } else if (value.is_number()) {
      metadata[key] = value.get<double>();
    }
  }
  metadata.erase(kind.key);
  return metadata;
}

}  // namespace ivory
