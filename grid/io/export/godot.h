// Light probes as a text resource of Godot 4: LightmapGIData.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "grid/export/probe_tetrahedra.h"

namespace ivory {

// Radiance coefficients of each point in ivory's order (sh9.h), in nits.
using ProbeCoefficients = std::vector<std::array<V3f, 9>>;

// What LightmapGIData::_set_probe_data() of scene/3d/lightmap_gi.cpp takes; `notes` become its metadata/ivory. Throws
// Error as write_file() does.
void write_godot_probes(const std::string& path, const ProbeTetrahedra& probes, const ProbeCoefficients& sh,
                        const Metadata& notes, bool force);

}  // namespace ivory
