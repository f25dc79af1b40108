// Distant light in a scene's file: glTF's extension EXT_lights_image_based.
#pragma once

#include <string>

#include "grid/export/distant.h"

namespace ivory {

// `scene`, .gltf or .glb, with the light as one more of the extension's and as that of each of its scenes; all else
// stays, and files that it names by relative paths are found from the new place too. The name's extension is to be the
// scene's. The coefficients are as the extension's one loader reads them (dialect.h); its prefiltered reflections,
// which the extension asks for, hold the mean light, as the asset knows no more. Throws Error where the scene cannot be
// read and as write_file() does.
void write_gltf_with_light(const std::string& path, const std::string& scene, const DistantLight& light, bool force);

}  // namespace ivory
