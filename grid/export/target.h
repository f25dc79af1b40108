// Where baked assets go: the table that the command line, its help, the documents and the tests share.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "grid/base/names.h"

namespace ivory {

enum class ExportTarget {
  three_js,
  babylon_js,
  playcanvas,
  filament,
  unity,
  godot,
  gltf,
  bevy,
  sides,
  sh9,
  nanovdb,
  usd,
  vrc,
  web
};
template <>
inline constexpr auto name_table<ExportTarget> =
    make_name_table<ExportTarget>("target", {{ExportTarget::three_js, "three.js"},
                                             {ExportTarget::babylon_js, "babylon.js"},
                                             {ExportTarget::playcanvas, "playcanvas"},
                                             {ExportTarget::filament, "filament"},
                                             {ExportTarget::unity, "unity"},
                                             {ExportTarget::godot, "godot"},
                                             {ExportTarget::gltf, "gltf"},
                                             {ExportTarget::bevy, "bevy"},
                                             {ExportTarget::sides, "sides"},
                                             {ExportTarget::sh9, "sh9"},
                                             {ExportTarget::nanovdb, "nanovdb"},
                                             {ExportTarget::usd, "usd"},
                                             {ExportTarget::vrc, "vrc"},
                                             {ExportTarget::web, "web"}});

enum class ExportAsset { distant, grid, scene };
template <>
inline constexpr auto name_table<ExportAsset> = make_name_table<ExportAsset>(
    "asset", {{ExportAsset::distant, "SH9 or DifMap"}, {ExportAsset::grid, "grid"}, {ExportAsset::scene, "scene"}});

// One file kind that a target takes of one kind of asset.
struct ExportFormat {
  ExportTarget target;
  ExportAsset asset;
  std::string_view extension;  // of the file, in lower case: ".json"; empty: a folder
  std::string_view beside;     // extensions of files that are written beside it, separated by spaces
  std::string_view holds;      // what is in it
};

// All of them, by asset, in the order of name_table<ExportTarget>.
std::span<const ExportFormat> export_formats();

// The format of that target, asset and extension (in lower case). Throws ParameterError, which says what there is, for
// none.
const ExportFormat& export_format(ExportTarget target, ExportAsset asset, std::string_view extension);

// The table as lines for a help page, two spaces before each.
std::string export_format_lines(ExportAsset asset);

}  // namespace ivory
