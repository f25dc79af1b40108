#include "grid/io/export/usd.h"

#include <filesystem>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/io/file.h"

namespace ivory {

namespace fs = std::filesystem;

void write_usd_volume(const std::string& path, const std::string& vdb, const std::vector<std::string>& names,
                      bool force) {
  std::error_code none;
  std::string asset = fs::relative(fs::absolute(vdb), fs::absolute(path).parent_path(), none).generic_string();
  if (none || asset.empty()) asset = fs::absolute(vdb).generic_string();
  if (!asset.starts_with("../") && !asset.starts_with('/')) asset = "./" + asset;  // from the stage, not a search path
  if (asset.find('@') != std::string::npos)
    throw Error(vdb, "has an @ in its path, which ends asset paths in USD files", "give it another name");
  std::string fields;
  std::string prims;
  for (const std::string& name : names) {
    // visible_fraction is the one grid of scalars. Hemispheres' vectors and S, C, F are directions in the grid's own
    // frame, which readers turn with it; all else is colour.
    const bool scalar = name.starts_with("visible_fraction");
    const bool vector = name.find("I_") != std::string::npos || name.starts_with("F_");
    fields += fmt::format("    rel field:{0} = </ivory/{0}>\n", name);
    prims += fmt::format(R"(
    def OpenVDBAsset "{}"
    {{
        asset filePath = @{}@
        token fieldName = "{}"
        token fieldDataType = "{}"
        token vectorDataRoleHint = "{}"
    }}
)",
                         name, asset, name, scalar ? "float" : "float3", vector ? "Vector" : "None");
  }
  write_file(
      path,
      fmt::format("#usda 1.0\n(\n    defaultPrim = \"ivory\"\n    metersPerUnit = 1\n    upAxis = \"Y\"\n    doc = "
                  "\"irradiance in lux, by ivory {}\"\n)\n\ndef Volume \"ivory\"\n{{\n{}{}}}\n",
                  IVORY_VERSION, fields, prims),
      force);
}

}  // namespace ivory
