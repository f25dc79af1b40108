// What every asset says about its own making: format, ivory version, method, all parameters,
// content hashes, seed, photon range, units. Names are lower_case; values are typed for JSON.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <variant>

namespace ivory {

using MetaValue = std::variant<std::int64_t, double, std::string>;
using Metadata = std::map<std::string, MetaValue>;

}  // namespace ivory
