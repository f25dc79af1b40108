// Volumes of probes as NanoVDB grids, for renderers on graphics cards.
#pragma once

#include <string>

#include "grid/export/probe_volume.h"

namespace ivory {

// A .nvdb file of six Vec3f grids E_px, E_mx, E_py, E_my, E_pz, E_mz: E in lux at the normals +x, -x ... of the world,
// RGB, a voxel a probe. Not compressed: it may be mapped into memory as it is. Throws Error as PendingFile does.
void write_nanovdb(const std::string& path, const ProbeVolume& volume, bool force);

}  // namespace ivory
