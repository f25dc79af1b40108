// Environment maps from image files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "grid/env/environment_image.h"

namespace ivory {

struct LoadedEnvironment {
  EnvironmentImage image;
  // One line each, with the path: what was assumed of the file, ignored, clamped or brought to nits of Rec.709.
  std::vector<std::string> warnings;
  // What it was read as where that is not plain linear Rec.709 in the file's only picture: environment_color_space,
  // environment_layer.
  Metadata facts;
};

// Reads OpenEXR and Radiance files, and any other image OpenImageIO knows (grid/io/picture/picture.h). The layout is
// `layout` where given, else what an OpenEXR file's `envmap` attribute says, else what the aspect ratio stands for.
// Colours are brought to Rec.709 and values to nits as the file says; 8 and 16 bits count as sRGB unless it says
// otherwise. Values below zero become zero. Throws Error for unreadable files, a size that the layout cannot have, a
// single texel, values that are not finite, and values below zero that amount to more than a hundredth of the light.
LoadedEnvironment load_environment_image(const std::string& path, std::optional<EnvironmentLayout> layout = {});

// The map alone, resampled to lat-long where the file has another layout.
EnvironmentMap load_environment(const std::string& path, std::optional<EnvironmentLayout> layout = {});

}  // namespace ivory
