#include "tools/input/group_factors.h"

#include <utility>

#include <fmt/format.h>

#include "tools/cli/numbers.h"
#include "tools/cli/usage_error.h"

namespace ivory {

namespace {

// "NAME=VALUE"; `value` in words.
std::pair<std::string, std::string> parse_assignment(const std::string& option, const std::string& text,
                                                     const char* value) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw UsageError(fmt::format("{}: '{}' is not a group and {}, as hall={}", option, text, value, value));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

void multiply(GroupFactors& factors, const std::string& group, const Rgb& factor) {
  factors.try_emplace(group, Rgb(1, 1, 1)).first->second *= factor;
}

}  // namespace

void add_group_factor_options(Command command, GroupFactors& factors, const GroupFactorOptions& names) {
  Option scale = command.add_option(
      names.scale,
      [&factors, option = names.scale](const std::string& text) {
        const auto [group, value] = parse_assignment(option, text, "FACTOR");
        const auto factor = parse_number(value);
        if (!factor || !(*factor >= 0)) throw UsageError(option + ": '" + value + "' is not a factor of 0 or more");
        multiply(factors, group, Rgb(1, 1, 1) * float(*factor));
      },
      "What a group's light is multiplied by; may be repeated [1]");
  Option tint = command.add_option(
      names.tint,
      [&factors, option = names.tint](const std::string& text) {
        const auto [group, value] = parse_assignment(option, text, "R,G,B");
        const V3d factor = parse_vector3(option, value);
        if (!(factor.x >= 0 && factor.y >= 0 && factor.z >= 0))
          throw UsageError(option + ": '" + value + "' is not three factors of 0 or more");
        multiply(factors, group, Rgb(factor));
      },
      "What the channels of a group's light are multiplied by, in linear Rec.709; may be repeated [1,1,1]");
  scale.repeated().type_name("GROUP=FACTOR");
  tint.repeated().type_name("GROUP=R,G,B");
  if (names.heading.empty()) return;
  scale.group(names.heading);
  tint.group(names.heading);
}

std::string text_of(const std::string& group, const Rgb& factor) {
  return fmt::format("{}={},{},{}", group, factor.x, factor.y, factor.z);
}

}  // namespace ivory
