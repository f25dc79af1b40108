// FIV tables as OpenEXR files: one picture, azimuth to the right, the spheres' polar angles downwards, sphere under
// sphere from the innermost. Channels Fx.R to Fz.B hold the FIV; with six hemispheres Dxx.R to Dzz.B follow.
// Attributes: radii, sphere (centre and radius in metres), coverage, total, and all of the table's metadata. Of a set
// of turns (attribute turns) all tables are in one picture, one below the other, with a coverage each.
#pragma once

#include <string>

#include "grid/fiv/set.h"
#include "grid/io/exr.h"

namespace ivory {

// Throws Error as write_exr() does.
void write_fiv(const std::string& path, const FivTable& table, ExrPrecision precision, bool force);

void write_fiv(const std::string& path, const FivSet& set, ExrPrecision precision, bool force);

// Throws Error as read_exr() does, and for attributes that make no table. Of a set the table of the unturned mesh.
FivTable read_fiv(const std::string& path);
// A set, or a table as a set of one; all turns have the metadata.
FivSet read_fiv_set(const std::string& path);

}  // namespace ivory
