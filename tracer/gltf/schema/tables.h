// How the tables of tables.cpp describe JSON. Private to the loader.
#pragma once

#include <span>
#include <string_view>

namespace ivory::gltf {

enum class Kind {
  string,
  boolean,
  number,
  integer,
  numbers,
  index,       // into the array `target`
  indices,     // several
  index_map,   // name -> index
  index_maps,  // several
  object,
  objects,
  one_of,
  strings
};

// Everything ends up as a float, with room for a few products.
inline constexpr double float_limit = 1e30;

struct Field;
using Schema = std::span<const Field>;

struct Field {
  const char* name;
  Kind kind;
  bool required = false;
  // Range of numbers; for `objects`, minimum is the least count.
  double minimum = -float_limit;
  double maximum = float_limit;
  std::size_t length = 0;        // of `numbers`; 0 for any
  const char* target = nullptr;  // "lights" is the array of KHR_lights_punctual
  Schema schema{};               // of an object, or of each of several
  std::string_view one_of{};     // allowed strings or integers, separated by blanks
  bool exclusive_minimum = false;
};

// Of the whole document, but for its animations.
Schema root_schema();
// Of the document's animations alone.
Schema animation_schema();

}  // namespace ivory::gltf
