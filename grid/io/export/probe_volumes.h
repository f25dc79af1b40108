// Volumes of probes for engines on graphics cards: one function a target. Each writes a KTX2 file and what stands
// beside it by the same name, and answers what it did to the numbers. Throw Error as write_file() does, and
// ParameterError (voxel_size) for textures that no graphics card need take.
#pragma once

#include <string>

#include "grid/io/export/probe_texture.h"

namespace ivory {

struct TextureResult {
  Ktx2Format format = Ktx2Format::rgba16f;
  float scale = 1;  // a power of two by which the reader is to multiply what is stored
};

// three.js' LightProbeGrid and LightProbeGridWebGL: the atlas, NAME.js with a loader of a few lines, NAME.json. Needs
// volume.sh, and probes along the world's axes. Half floats, or floats where halves do not hold the light.
TextureResult write_three_js_volume(const std::string& path, const ProbeVolume& volume, const ProbeExport& about,
                                    bool force);

// Its atlas alone, for grids that stand where that one does.
TextureResult write_three_js_atlas(const std::string& path, const ProbeVolume& volume, const ProbeExport& about,
                                   bool force);

// Bevy's IrradianceVolume: E / pi / scale of six sides, where the scale is the component's `intensity`; NAME.json has
// its Transform. `format`: rgba16f or e5b9g9r9.
TextureResult write_bevy_volume(const std::string& path, const ProbeVolume& volume, const ProbeExport& about,
                                Ktx2Format format, bool force);

// E of six sides in lux / scale, sides +x -x +y -y +z -z one behind the other (padded_atlas()); alpha, where the format
// has it, is 1 for measured probes, 0.5 for filled and 0 for dark ones. NAME.json says so too.
TextureResult write_sides_volume(const std::string& path, const ProbeVolume& volume, const ProbeExport& about,
                                 Ktx2Format format, bool force);

// The nine radiance coefficients in nits / scale, one behind the other, alpha as above; half floats.
TextureResult write_sh9_volume(const std::string& path, const ProbeVolume& volume, const ProbeExport& about,
                               bool force);

}  // namespace ivory
