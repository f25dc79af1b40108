// The readers behind read_picture(), one a kind of format. Private to grid/io.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "grid/io/picture/picture.h"

namespace ivory {

// OpenEXR: own code rather than OpenImageIO's, which takes the first three channels of the first part for R, G, B.
//
// R, G and B by name, or luminance; of several layers or parts the one that is called like the finished picture.
// Outside of the data window there is black, and beyond the display window nothing, unless the file says by its envmap
// attribute that the data window is the environment. Throws Error where no layer is the obvious one.
bool is_exr_picture(const std::string& path);
StoredPicture read_exr_picture(const std::string& path, const std::string& remedy);

// Radiance (.hdr, .pic): own code, as OpenImageIO ignores the header's exposure, colour format and order of lines, and
// refuses old run-length encoding. Values are divided by EXPOSURE and COLORCORR. Throws Error for other formats than
// rgbe and xyze, and damaged files.
bool is_radiance_picture(const std::string& path);
StoredPicture read_radiance_picture(const std::string& path, const std::string& remedy);

// The primaries that a PNG's chunk cHRM states, which OpenImageIO does not tell; none where sRGB or a profile stands in
// its place.
std::optional<Primaries> png_primaries(const std::string& path);

// Throws Error where no compression could hold so many pixels in the file's bytes: before memory is taken for them.
void check_claimed_size(const std::string& path, std::int64_t width, std::int64_t height);

// All else.
StoredPicture read_other_picture(const std::string& path, const std::string& remedy);

}  // namespace ivory
