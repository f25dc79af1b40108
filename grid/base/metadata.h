// What every asset says about its own making: format, ivory version, method, all parameters, content hashes, seed,
// photon range, units. Keys are lower_case; values are typed, as in JSON.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>

namespace ivory {

using MetaValue = std::variant<std::int64_t, double, std::string>;
using Metadata = std::map<std::string, MetaValue>;

// The value of that key; nothing where there is none, or one of another type.
std::optional<std::string> find_text(const Metadata& metadata, const std::string& key);
std::optional<std::int64_t> find_int(const Metadata& metadata, const std::string& key);
// Integers too.
std::optional<double> find_number(const Metadata& metadata, const std::string& key);

}  // namespace ivory
