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
// A grid, or what the sums of a part or a checkpoint have come to: the light of the photons so far, as a preview of the
// grid. Its metadata says by photon_begin, photon_end and photons how many those are of how many.
IrradianceGrid load_grid_or_sums_vdb(const std::string& path, bool with_groups = false);
Metadata load_vdb_info(const std::string& path);

}  // namespace ivory
