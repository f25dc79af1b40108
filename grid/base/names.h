// The names that files, messages and the command line give to an enum's values: one table an enum, right beside it.
//
//   enum class Guard { off, planes, rays };
//   template <>
//   inline constexpr auto name_table<Guard> = make_name_table<Guard>("guard", {{Guard::rays, "rays"}, ...});
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "grid/base/error.h"

namespace ivory {

template <typename Enum>
struct NamedValue {
  Enum value;
  std::string_view name;
};

template <typename Enum, std::size_t N>
struct NameTable {
  std::string_view what;  // a value is one: "guard"
  std::array<NamedValue<Enum>, N> entries;
};

// In the order in which help pages and messages list the names.
template <typename Enum, std::size_t N>
constexpr NameTable<Enum, N> make_name_table(std::string_view what, const NamedValue<Enum> (&entries)[N]) {
  return {what, std::to_array(entries)};
}

// Specialised beside each enum with names.
template <typename Enum>
inline constexpr std::nullptr_t name_table = nullptr;

// Empty for a value without name.
template <typename Enum>
constexpr std::string_view name_of(Enum value) {
  for (const auto& entry : name_table<Enum>.entries) {
    if (entry.value == value) return entry.name;
  }
  return {};
}

// All names of the enum, in the order of its table.
template <typename Enum>
std::vector<std::string> names_of() {
  std::vector<std::string> names;
  for (const auto& entry : name_table<Enum>.entries) names.emplace_back(entry.name);
  return names;
}

// All values that have a name, as a std::array in the order of the table.
template <typename Enum>
constexpr auto values_of() {
  std::array<Enum, name_table<Enum>.entries.size()> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = name_table<Enum>.entries[i].value;
  return values;
}

// The value of that name, case-sensitive; nothing where there is none.
template <typename Enum>
std::optional<Enum> find_by_name(std::string_view name) {
  for (const auto& entry : name_table<Enum>.entries) {
    if (entry.name == name) return entry.value;
  }
  return std::nullopt;
}

// Throws ParameterError, which lists all names, for an unknown one.
template <typename Enum>
Enum from_name(std::string_view name) {
  if (const std::optional<Enum> value = find_by_name<Enum>(name)) return *value;
  std::string known;
  for (const auto& entry : name_table<Enum>.entries) known += (known.empty() ? "" : ", ") + std::string(entry.name);
  throw ParameterError(std::string(name_table<Enum>.what), "'" + std::string(name) + "' is unknown; one of " + known);
}

}  // namespace ivory
