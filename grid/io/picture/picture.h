// Pictures of all formats as their files mean them: turned the right way up, the right layer, and what its numbers are.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "grid/env/layout.h"
#include "grid/io/picture/primaries.h"

namespace ivory {

enum class Transfer { linear, srgb, power };

struct StoredPicture {
  int width = 0;
  int height = 0;
  std::vector<Rgb> texels;  // as stored, top row first, each from the left
  // How stored values s become light: linear s, IEC 61966-2-1, or s^gamma.
  Transfer transfer = Transfer::linear;
  double gamma = 1;
  Primaries primaries;                      // that the light refers to
  double nits = 1;                          // luminance of linear (1, 1, 1), where the file says it
  std::optional<EnvironmentLayout> layout;  // as its envmap attribute says
  std::string asset;                        // kind of asset that ivory baked, or empty
  std::string layer;                        // of an OpenEXR file with named layers or parts
  // What was assumed, ignored or changed, one line each, without the path: of the texels, and of what they mean.
  std::vector<std::string> warnings;
  std::vector<std::string> color_warnings;
};

// Reads OpenEXR and Radiance files and all that OpenImageIO knows. Of files with alpha the colour alone. Throws Error,
// with `remedy`, for files that cannot be read or are no pictures.
StoredPicture read_picture(const std::string& path, const std::string& remedy);

// The light of a stored value, before primaries and nits.
float linear_from_stored(const StoredPicture& picture, float value);
// "linear", "sRGB" or "power 2.2".
std::string transfer_name(const StoredPicture& picture);

}  // namespace ivory
