// What ivory export was asked for.
#pragma once

#include <optional>
#include <string>

#include "grid/base/names.h"
#include "grid/export/target.h"

namespace ivory {

enum class ExportTexels { half, rgb9e5 };
template <>
inline constexpr auto name_table<ExportTexels> =
    make_name_table<ExportTexels>("texels", {{ExportTexels::half, "half"}, {ExportTexels::rgb9e5, "rgb9e5"}});

struct ExportOptions {
  std::string asset;
  ExportTarget target = ExportTarget::three_js;
  std::string output;
  std::string scene;                  // that distant light is put into, or that a grid's report is of
  std::string grid;                   // of a scene for a page
  std::string sh9;                    // of its surroundings
  std::string three;                  // folder of three.js' npm package; empty: found as Node.js does
  std::string report;                 // page to write about a grid; empty: none
  std::optional<float> voxel_size_m;  // between probes of a grid
  ExportTexels texels = ExportTexels::half;
};

}  // namespace ivory
