// glTF 2.0 and GLB to Scene.
#pragma once

#include <string>
#include <vector>

#include "tracer/scene.h"

namespace ivory {

struct LoadedScene {
  Scene scene;
  std::vector<std::string> warnings;  // one line each: what was ignored or mended, and where
};

// Loads the file's default scene (the first where it names none). Throws Error naming the file,
// the cause and a remedy for anything that cannot be rendered right: malformed JSON or GLB,
// accessors out of their buffers, indices out of range, non-finite positions, an unknown required
// extension, a node cycle. What can be left out without changing the light is a warning.
LoadedScene load_gltf(const std::string& path);

}  // namespace ivory
