// DifMaps as OpenEXR files: six faces from top to bottom with the attribute envmap = cube, channels R G B in float,
// irradiance in lux.
#pragma once

#include <string>

#include "grid/env/difmap.h"

namespace ivory {

// Adds the versions of format and ivory to the metadata. Throws Error as write_exr() does.
void write_difmap(const std::string& path, const DifMap& map, bool force);

// Throws Error as read_exr() does, and where the picture has not the shape of six faces or E is negative.
DifMap read_difmap(const std::string& path);

// From the header alone.
bool is_difmap(const std::string& path);

}  // namespace ivory
