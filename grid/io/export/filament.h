// Distant light as Filament's tools hand it on.
#pragma once

#include <string>

#include "grid/export/distant.h"

namespace ivory {

// cmgen's sh.txt: nine lines "( r,  g,  b); // L00, irradiance, pre-scaled base". Throws Error as write_file() does.
void write_filament_text(const std::string& path, const DistantLight& light, bool force);

// A KTX1 file with the nine coefficients as metadata "sh", which Ktx1Bundle::getSphericalHarmonics() reads, and a cube
// map of E / pi, which is what a fully rough mirror shows; all its levels hold the same light. Answers by what the cube
// was divided, a power of two: 1 unless it holds more than the format's 64512 nits.
float write_filament_ktx(const std::string& path, const DistantLight& light, bool force);

}  // namespace ivory
