// KTX 1.1 cube maps of R11F_G11F_B10F, as Filament's cmgen writes and its Ktx1Bundle reads them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "grid/base/types.h"

namespace ivory {

// levels[i]: 6 x size x size texels, size = `size` halved i times; faces +X -X +Y -Y +Z -Z, each with its first row at
// the top. `notes` are keys and text.
std::string ktx1_cube_bytes(int size, const std::vector<std::vector<Rgb>>& levels,
                            const std::map<std::string, std::string>& notes);

}  // namespace ivory
