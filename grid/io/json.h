// What ivory's JSON assets have in common: an entry that says what the file is, "format_version", and metadata beside
// the asset's own entries.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "grid/base/metadata.h"
#include "grid/base/types.h"

namespace ivory {

using Json = nlohmann::ordered_json;

struct JsonAssetKind {
  const char* name;              // "sh9"
  const char* key;               // of the entry that says so,
  const char* value;             // and its text
  const char* what;              // it is called in messages: "SH9 file"
  std::uintmax_t largest_bytes;  // far beyond what is written; more is not parsed
  const char* remedy;            // how to make one
};
inline constexpr JsonAssetKind json_sh9{"sh9",      "format", "ivory sh9",
                                        "SH9 file", 1 << 20,  "bake it with 'ivory bake sh9'"};
inline constexpr JsonAssetKind json_spheres{"spheres",    "ivory_asset", "spheres",
                                            "sphere set", 256U << 20U,   "make one with 'ivory bake spheres'"};
inline constexpr std::int64_t json_format_version = 1;

// The object that the file holds. Throws Error for what cannot be read, is too large, is no JSON object of that kind,
// or has another format version.
Json read_json_asset(const std::string& path, const JsonAssetKind& kind);

// The name of the kind of JSON asset that a file is; empty for all else. Reads no farther than the entry that says so.
std::string json_asset_kind(const std::string& path);

// An entry for each key.
Json to_json(const Metadata& metadata);
// Nine coefficients of three channels: [[r, g, b], ...].
Json to_json(const std::array<V3d, 9>& coefficients);
// All entries that are text or numbers, but for the one that names the kind.
Metadata metadata_from_json(const Json& object, const JsonAssetKind& kind);

}  // namespace ivory
