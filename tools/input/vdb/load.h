// .vdb files as the command line reads them: one that does not bear ivory's checksum is first read in a process of its
// own, because OpenVDB may crash over damage.
#pragma once

#include <string>

#include "grid/field/accumulator.h"

namespace ivory {

// As read_grid_vdb(), read_accumulator_vdb() and read_vdb_info() of grid/io/vdb/vdb.h; Error also where OpenVDB
// crashes.
IrradianceGrid load_grid_vdb(const std::string& path, bool with_groups = false);
GridAccumulator load_accumulator_vdb(const std::string& path);
Metadata load_vdb_info(const std::string& path);

}  // namespace ivory
