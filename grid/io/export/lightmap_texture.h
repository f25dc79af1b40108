// Lightmaps as textures for engines.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "grid/base/types.h"
#include "grid/io/ktx/ktx2.h"

namespace ivory {

// A 2D texture of E in lux, first row first (v = 0 of glTF), zstd: half floats, or floats where halves do not hold the
// light. Answers which. `notes` are kept in the file. Throws Error as write_file() does.
Ktx2Format write_lightmap_texture(const std::string& path, int width, int height, const std::vector<Rgb>& e,
                                  const std::map<std::string, std::string>& notes, bool force);

}  // namespace ivory
