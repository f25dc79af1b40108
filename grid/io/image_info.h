// What an image file says about itself.
#pragma once

#include <string>

#include "grid/base/metadata.h"

namespace ivory {

// format, width, height, channels ("R G B"), pixel_type, and every attribute that ivory wrote (ivory:method and the
// like, without the prefix). Throws Error where OpenImageIO cannot open the file.
Metadata read_image_info(const std::string& path);

}  // namespace ivory
