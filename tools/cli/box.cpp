#include "tools/cli/box.h"

#include <fmt/format.h>

#include "tools/cli/numbers.h"

namespace ivory {

Imath::Box3d parse_box(std::string_view option, std::string_view text, std::string_view form) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) throw UsageError(fmt::format("{} takes {}, not '{}'", option, form, text));
  Imath::Box3d box;
  box.extendBy(parse_vector3(option, text.substr(0, colon)));
  box.extendBy(parse_vector3(option, text.substr(colon + 1)));
  return box;
}

Imath::Box3d parse_bounds(std::string_view option, std::string_view text) {
  Imath::Box3d box = parse_box(option, text, "a box X0,Y0,Z0:X1,Y1,Z1");
  const V3d size = box.size();
  constexpr double longest_m = 1e9;
  if (!(size.x > 0) || !(size.y > 0) || !(size.z > 0) || !(size.length() < longest_m)) {
    throw UsageError(
        fmt::format("{}: '{}' must have some extent along each axis, and less than a million km", option, text));
  }
  return box;
}

}  // namespace ivory
