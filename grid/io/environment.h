// Environment maps from image files.
#pragma once

#include <optional>
#include <string>

#include "grid/env/environment_image.h"

namespace ivory {

// Reads any image OpenImageIO knows. The layout is `layout` where given, else what an OpenEXR file's `envmap` attribute
// says, else what the aspect ratio stands for. Throws Error for unreadable files, a size that the layout cannot have, a
// single texel, and values that are negative or not finite.
EnvironmentImage load_environment_image(const std::string& path, std::optional<EnvironmentLayout> layout = {});

// The same, resampled to lat-long where the file has another layout.
EnvironmentMap load_environment(const std::string& path, std::optional<EnvironmentLayout> layout = {});

}  // namespace ivory
