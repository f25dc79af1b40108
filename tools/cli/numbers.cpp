#include "tools/cli/numbers.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "grid/base/error.h"

namespace ivory {

namespace {

[[noreturn]] void refuse(std::string_view option, std::string_view text, std::string_view expected) {
  throw UsageError(fmt::format("{}: '{}' is not {}", option, text, expected));
}

// All of `text` as a plain number.
template <typename T>
std::optional<T> number_from(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

std::optional<std::uint64_t> count_from(std::string_view text) {
  constexpr std::uint64_t limit = std::numeric_limits<std::int64_t>::max();  // files store int64
  std::uint64_t unit = 1;
  if (!text.empty()) {
    switch (text.back()) {
      case 'k':
      case 'K':
        unit = 1'000;
        break;
      case 'm':
      case 'M':
        unit = 1'000'000;
        break;
      case 'g':
      case 'G':
        unit = 1'000'000'000;
        break;
      default:
        break;
    }
    if (unit != 1) text.remove_suffix(1);
  }
  // Integer arithmetic throughout, so that large counts stay exact.
  const std::size_t point = text.find('.');
  const std::string_view whole_text = text.substr(0, point);
  const auto whole = number_from<std::uint64_t>(whole_text);
  if (!whole || *whole > limit / unit) return std::nullopt;
  std::uint64_t count = *whole * unit;
  if (point != std::string_view::npos) {
    const std::string_view digits = text.substr(point + 1);
    if (digits.empty()) return std::nullopt;
    for (const char digit : digits) {
      if (digit < '0' || digit > '9') return std::nullopt;
      unit /= 10;
      if (unit == 0 && digit != '0') return std::nullopt;
      count += std::uint64_t(digit - '0') * unit;
    }
  }
  if (count > limit) return std::nullopt;
  return count;
}

}  // namespace

std::optional<double> parse_number(std::string_view text) { return number_from<double>(text); }
std::optional<float> parse_float(std::string_view text) { return number_from<float>(text); }

std::uint64_t parse_count(std::string_view option, std::string_view text) {
  const auto count = count_from(text);
  if (!count) refuse(option, text, "a count (a whole number, or 250k, 8m, 1.5g)");
  return *count;
}

V3i parse_size3(std::string_view option, std::string_view text, int least) {
  const auto parts = split(text, ',');
  V3i size;
  for (int axis = 0; axis < 3; ++axis) {
    const auto value = number_from<int>(parts[parts.size() == 1 ? 0 : std::min(std::size_t(axis), parts.size() - 1)]);
    if ((parts.size() != 1 && parts.size() != 3) || !value || *value < least || *value > 65536)
      refuse(option, text, fmt::format("NX,NY,NZ (or one number for all three), each from {} to 65536", least));
    size[axis] = *value;
  }
  return size;
}

Imath::V2i parse_image_size(std::string_view option, std::string_view text) {
  const auto parts = split(text, 'x');
  const auto width = number_from<int>(parts[0]);
  const auto height = number_from<int>(parts.back());
  if (parts.size() != 2 || !width || !height || *width < 1 || *height < 1 || *width > 65536 || *height > 65536)
    refuse(option, text, "WxH in pixels, such as 640x480, each from 1 to 65536");
  return {*width, *height};
}

std::pair<std::uint64_t, std::uint64_t> parse_range(std::string_view option, std::string_view text) {
  const auto parts = split(text, ':');
  const auto begin = count_from(parts[0]);
  const auto end = count_from(parts.back());
  if (parts.size() != 2 || !begin || !end || *begin >= *end)
    refuse(option, text, "a range A:B with A < B, such as 0:8m (B itself is left out)");
  return {*begin, *end};
}

std::vector<double> parse_numbers(std::string_view option, std::string_view text, std::size_t count,
                                  std::string_view form) {
  std::vector<double> values;
  for (const std::string_view part : split(text, ',')) {
    const auto value = number_from<double>(part);
    if (!value || !std::isfinite(float(*value))) refuse(option, text, form);
    values.push_back(*value);
  }
  if (values.size() != count) refuse(option, text, form);
  return values;
}

V3d parse_vector3(std::string_view option, std::string_view text) {
  const std::vector<double> v = parse_numbers(option, text, 3, "X,Y,Z");
  return {v[0], v[1], v[2]};
}

double shortest(float value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return parse_number(std::string_view(text.data(), std::size_t(end - text.data()))).value_or(double(value));
}

std::array<double, 3> shortest(const V3f& p_local, const V3d& anchor_m) {
  std::array<double, 3> place{};
  for (unsigned axis = 0; axis < 3; ++axis)
    place[axis] = anchor_m[axis] == 0 ? shortest(p_local[axis]) : double(p_local[axis]) + anchor_m[axis];
  return place;
}

std::string format_count(double count) {
  const std::array<std::pair<double, const char*>, 3> units{{{1e9, " G"}, {1e6, " M"}, {1e3, " k"}}};
  for (const auto& [unit, suffix] : units) {
    if (count >= 0.9995 * unit) return fmt::format("{:.3g}{}", count / unit, suffix);
  }
  return fmt::format("{:.3g}", count);
}

std::string format_duration(double seconds) {
  if (!(seconds < 1e9)) return "unknown time";
  const auto total = static_cast<std::int64_t>(std::llround(seconds));
  const std::int64_t hours = total / 3600;
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, total / 60 % 60, total % 60);
  return fmt::format("{}:{:02}", total / 60, total % 60);
}

std::string format_bytes(std::uint64_t bytes) {
  const auto value = static_cast<double>(bytes);
  if (value >= 0x1p30) return fmt::format("{:.4g} GiB", value / 0x1p30);
  if (value >= 0x1p20) return fmt::format("{:.4g} MiB", value / 0x1p20);
  if (value >= 0x1p10) return fmt::format("{:.4g} KiB", value / 0x1p10);
  return fmt::format("{} bytes", bytes);
}

}  // namespace ivory
