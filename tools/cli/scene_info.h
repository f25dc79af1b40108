// What `ivory info` says of a scene: its size, its lights and what they amount to, what is odd about it.
#pragma once

#include "grid/io/json.h"
#include "tools/cli/common.h"
#include "tools/input/scene.h"

namespace ivory {

// Counts, bounds (metres), total power (lumen), each punctual light with its strength and flux, the loader's warnings,
// and hints at usual mistakes. Throws Error as load_scene_input() does.
Json scene_info(const std::string& path, const SceneOptions& options, const CommonOptions& common);

}  // namespace ivory
