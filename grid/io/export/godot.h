// Light probes as a text resource of Godot 4: LightmapGIData.
#pragma once

#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "grid/export/probe_tetrahedra.h"

namespace ivory {

// What LightmapGIData::_set_probe_data() of scene/3d/lightmap_gi.cpp takes; `notes` become its metadata/ivory. Throws
// Error as write_file() does.
void write_godot_probes(const std::string& path, const ProbeTetrahedra& probes, const std::vector<ProbeSh9>& sh,
                        const Metadata& notes, bool force);

}  // namespace ivory
