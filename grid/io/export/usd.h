// A grid's .vdb file as a volume of a USD stage.
#pragma once

#include <string>
#include <vector>

namespace ivory {

// A .usda stage with one Volume, "ivory", whose fields are the grids `names` of the OpenVDB file `vdb` (OpenVDBAsset
// prims of usdVol), named by a path relative to the stage. The grids carry their own transforms. Throws Error as
// write_file() does.
void write_usd_volume(const std::string& path, const std::string& vdb, const std::vector<std::string>& names,
                      bool force);

}  // namespace ivory
