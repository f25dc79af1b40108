#include "tools/batch/job/units.h"

#include <array>
#include <cctype>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "tools/cli/numbers.h"

namespace ivory {

namespace {

struct Unit {
  std::string_view name;
  double factor;
};

constexpr std::array lengths{Unit{"mm", 1e-3}, Unit{"cm", 1e-2}, Unit{"m", 1}, Unit{"km", 1e3}};
constexpr std::array angles{Unit{"deg", 1}, Unit{"°", 1}, Unit{"rad", 180 / 3.14159265358979323846}};
constexpr std::array seconds{Unit{"s", 1}, Unit{"min", 60}, Unit{"h", 3600}};
constexpr std::array minutes{Unit{"s", 1.0 / 60}, Unit{"min", 1}, Unit{"h", 60}};
// Decimal and binary; k, m and g alone are those of the command line, which reads them itself.
constexpr std::array bytes{Unit{"B", 1},         Unit{"KB", 1e3},      Unit{"MB", 1e6},     Unit{"GB", 1e9},
                           Unit{"KiB", 1 << 10}, Unit{"MiB", 1 << 20}, Unit{"GiB", 1 << 30}};
constexpr std::array stops{Unit{"stops", 1}, Unit{"EV", 1}};

std::span<const Unit> units_of(std::string_view type) {
  type = type.substr(0, type.find(':'));  // the rest is a validator's
  if (type == "METRES" || type == "M" || type == "X,Y,Z" || type == "X0,Y0,Z0:X1,Y1,Z1" || type == "none|BOX")
    return lengths;
  if (type == "DEGREES") return angles;
  if (type == "SECONDS") return seconds;
  if (type == "MINUTES" || type == "MIN") return minutes;
  if (type == "BYTES") return bytes;
  if (type == "STOPS") return stops;
  return {};
}

// One number with its unit.
std::optional<std::string> plain(std::string_view text, std::span<const Unit> units) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  if (parse_number(text)) return std::string(text);
  for (const Unit& unit : units) {
    if (!text.ends_with(unit.name)) continue;
    std::string_view number = text.substr(0, text.size() - unit.name.size());
    while (!number.empty() && number.back() == ' ') number.remove_suffix(1);
    const auto value = parse_number(number);
    if (!value) continue;
    if (unit.factor == 1) return std::string(number);
    // 57 cm are 0.57 m, which 57 * 0.01 is not.
    return fmt::format("{}", unit.factor < 1 ? *value / std::round(1 / unit.factor) : *value * unit.factor);
  }
  return std::nullopt;
}

}  // namespace

std::string units_for(std::string_view type_name) {
  std::string names;
  for (const Unit& unit : units_of(type_name)) names += (names.empty() ? "" : ", ") + std::string(unit.name);
  return names;
}

std::optional<std::string> without_units(std::string_view text, std::string_view type_name) {
  const std::span<const Unit> units = units_of(type_name);
  const auto is_number = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  // What is no number at all ("none") is for the option to judge, and so are the k, m, g of its own.
  if (units.empty() || text.empty() || !(is_number(text.front()) || text.front() == '-' || text.front() == '.'))
    return std::string(text);
  const bool own_suffix =
      units.data() == bytes.data() && is_number(text[text.size() - std::min<std::size_t>(2, text.size())]);
  if (own_suffix && std::string_view("kmg").find(text.back()) != std::string_view::npos) return std::string(text);
  // A list keeps its separators.
  std::string out;
  while (true) {
    const std::size_t end = text.find_first_of(",:");
    const auto number = plain(text.substr(0, end), units);
    if (!number) return std::nullopt;
    out += *number;
    if (end == std::string_view::npos) return out;
    out += text[end];
    text.remove_prefix(end + 1);
  }
}

}  // namespace ivory
