// Baked assets as OpenEXR files: named channels, everything about their making as attributes, and a checksum. FIV
// tables, irradiance cube maps, localized cube maps and lobe tables are kept so.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "grid/base/names.h"

namespace ivory {

enum class ExrPrecision { float32, float16 };
template <>
inline constexpr auto name_table<ExrPrecision> = make_name_table<ExrPrecision>("precision",
                                                                               {{ExrPrecision::float32, "float32"},
                                                                                {ExrPrecision::float16, "float16"}});

struct ExrAsset {
  std::string kind;  // of asset: "fiv", "difmap", ...; attribute ivory:asset
  int width = 0;
  int height = 0;
  std::vector<std::string> channels;                // in the order of `values`, at least one
  std::vector<float> values;                        // height x width x channels, top row first
  Metadata metadata;                                // attributes ivory:<name>
  std::map<std::string, std::vector<float>> lists;  // attributes ivory:<name>, float vectors
  // Adds OpenEXR's `envmap` attribute: the picture is six square faces, +X on top, as ImfEnvmap.h orients them.
  bool cube_environment = false;
};

// Losslessly compressed, whole or not at all. Throws Error where the file exists and not `force`, where it cannot be
// written, and where a value is not finite or, in float16, beyond 65504.
void write_exr(const std::string& path, const ExrAsset& asset, ExrPrecision precision, bool force);

// Throws Error for files that are not OpenEXR, hold another kind of asset or none (`remedy` says how to make one), are
// damaged (checksum), too large for this machine, or hold values that are not finite.
ExrAsset read_exr(const std::string& path, const std::string& kind, const std::string& remedy);

// The kind of asset that a file holds, from its header alone; empty where it is not an OpenEXR file by ivory.
std::string exr_asset_kind(const std::string& path);

}  // namespace ivory
