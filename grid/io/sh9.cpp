#include "grid/io/sh9.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/io/file.h"
#include "grid/io/json.h"

namespace ivory {

namespace {

Json window_json(const Sh9Window& window) { return {1, window.band1, window.band2}; }

Json matrices_json(const Sh9Matrices& matrices) {
  Json list = Json::array();
  for (const auto& matrix : matrices) {
    Json rows = Json::array();
    for (std::size_t r = 0; r < 4; ++r)
      rows.push_back({matrix[4 * r], matrix[4 * r + 1], matrix[4 * r + 2], matrix[4 * r + 3]});
    list.push_back(rows);
  }
  return list;
}

std::string text_of(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n'; }

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path), json_(read_json_asset(path, json_sh9)) {}

  [[noreturn]] void refuse(const std::string& cause) const { throw Error(path_, cause, json_sh9.remedy); }

  const Json& at(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) refuse(std::string("has no \"") + key + "\"");
    return *found;
  }
  double number(const Json& value, const char* key) const {
    if (!value.is_number()) refuse(std::string("\"") + key + "\" holds something that is no number");
    const auto x = value.get<double>();
    if (!std::isfinite(x)) refuse(std::string("\"") + key + "\" holds a number that is not finite");
    return x;
  }
  const Json& list(const Json& value, const char* key, std::size_t size) const {
    if (!value.is_array() || value.size() != size) {
      const std::string name = key;
      const char* const shape = name == "matrices" ? "3 x 4 x 4" : (name == "window" ? "3" : "9 x 3");
      refuse("\"" + name + "\" has not the shape " + shape);
    }
    return value;
  }
  const Json& json() const { return json_; }

 private:
  std::string path_;
  Json json_;
};

}  // namespace

void write_sh9(const std::string& path, const Sh9Asset& asset, bool force) {
  Json json{{json_sh9.key, json_sh9.value},
            {"format_version", json_format_version},
            {"ivory_version", IVORY_VERSION},
            {"order", asset.order},
            {"window", window_json(asset.window)},
            {"average_error", asset.error.average},
            {"maximum_error", asset.error.maximum},
            {"average_error_of_mean_irradiance", asset.error.average_of_mean_e()},
            {"maximum_error_of_mean_irradiance", asset.error.maximum_of_mean_e()},
            {"units",
             "coefficients nits sr^(1/2), (n 1) M (n 1)^T irradiance in lux; errors relative to the light of "
             "the whole sphere"},
            {"coefficient_order", {"L00", "L1-1", "L10", "L11", "L2-2", "L2-1", "L20", "L21", "L22"}},
            {"coefficients", to_json(asset.sh.coefficients)},
            {"matrices", matrices_json(sh9_matrices(asset.sh))}};
  json.update(to_json(asset.metadata));
  write_file(path, text_of(json), force);
}

Sh9Asset read_sh9(const std::string& path) {
  const Reader reader(path);
  Sh9Asset asset;
  const double order = reader.number(reader.at("order"), "order");
  if (order != 0 && order != 1 && order != 2) reader.refuse("has an order that is not 0, 1 or 2");
  asset.order = int(order);
  const Json& window = reader.list(reader.at("window"), "window", 3);
  asset.window = {reader.number(window[1], "window"), reader.number(window[2], "window")};
  asset.error.average = reader.number(reader.at("average_error"), "average_error");
  asset.error.maximum = reader.number(reader.at("maximum_error"), "maximum_error");
  const Json& coefficients = reader.list(reader.at("coefficients"), "coefficients", 9);
  double scale = 0;
  for (std::size_t i = 0; i < 9; ++i) {
    const Json& rgb = reader.list(coefficients[i], "coefficients", 3);
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = reader.number(rgb[c], "coefficients");
      if (std::abs(value) > 1e30) reader.refuse("\"coefficients\" holds a number beyond 1e30");
      asset.sh.coefficients[i][int(c)] = value;
      scale = std::max(scale, std::abs(value));
    }
  }
  const Sh9Matrices expected = sh9_matrices(asset.sh);
  const Json& matrices = reader.list(reader.at("matrices"), "matrices", 3);
  for (std::size_t c = 0; c < 3; ++c) {
    const Json& rows = reader.list(matrices[c], "matrices", 4);
    for (std::size_t r = 0; r < 4; ++r) {
      const Json& row = reader.list(rows[r], "matrices", 4);
      for (std::size_t k = 0; k < 4; ++k) {
        // Either may have been written with seven digits.
        if (std::abs(reader.number(row[k], "matrices") - expected[c][4 * r + k]) > 1e-5 * scale)
          reader.refuse("its matrices do not belong to its coefficients");
      }
    }
  }
  asset.metadata = metadata_from_json(reader.json(), json_sh9);
  std::erase_if(asset.metadata, [](const auto& entry) {
    return entry.first == "order" || entry.first.starts_with("average_error") ||
           entry.first.starts_with("maximum_error");
  });
  return asset;
}

bool is_sh9_name(const std::string& path) { return lower_extension(path) == ".json"; }

}  // namespace ivory
