// Volumes of probes as Unity's text assets. Its world is left-handed: x is mirrored, as glTF importers mirror it.
#pragma once

#include <string>

#include "grid/io/export/probe_volumes.h"

namespace ivory {

// LightProbes: positions, and nine coefficients of E / pi each (SphericalHarmonicsL2, docs/export.md). It holds no
// tetrahedra: LightProbes.Tetrahedralize() makes them. Probes that are dark are left out. Needs volume.sh. Throws Error
// as write_file() does, and ParameterError (voxel_size) for more probes than `most_unity_probes`.
inline constexpr std::size_t most_unity_probes = 200000;
// Answers how many probes are written.
std::size_t write_unity_probes(const std::string& path, const ProbeVolume& volume, bool force);

// The three textures of VRC Light Volumes' LightVolume: L0 and L1 of E / pi in half floats, NAME.asset, NAME.1.asset
// and NAME.2.asset, and NAME.json with the transform. Needs volume.sh and probes along the world's axes. Answers the
// power of two by which the stored light is to be multiplied.
float write_vrc_volume(const std::string& path, const ProbeVolume& volume, const ProbeExport& about, bool force);

// What that component's shader shows: max(L0 + L1 . n, 0) times pi, lux, with linear filtering. L1 is no longer than
// L0, as its own baker has it.
ProbeReader vrc_reader(const ProbeVolume& volume);

}  // namespace ivory
