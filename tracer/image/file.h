// Films to image files and back, through OpenImageIO.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "tracer/core/film.h"

namespace ivory {

// True where the format of that name's extension keeps linear light: .exr, .hdr, .tif. The others
// (.png, .jpg, ...) hold display values.
bool is_linear_image(const std::string& path);

// Throws Error where the extension names no image format: to be asked before hours of rendering.
void check_image_name(const std::string& path);

// One more channel of a picture.
struct ImageChannel {
  std::string name;           // "albedo.R"
  std::vector<float> values;  // height x width, top row first
};

// Writes float linear RGB, or 8-bit sRGB after 2^exposure_stops and tone_map(). Every entry of `metadata`
// becomes an attribute "ivory:<name>" where the format keeps attributes. OpenEXR keeps `more` beside R, G and B; other
// formats leave it out. Whole or not at all; throws Error where the file exists and not `force`, cannot be written, or
// its format is unknown.
void write_image(const std::string& path, const Film& film, float exposure_stops, const Metadata& metadata, bool force,
                 const std::vector<ImageChannel>& more = {});

// What write_image() puts into the others before it is rounded: height x width x 3, sRGB from 0 to 1.
std::vector<float> display_values(const Film& film, float exposure_stops);

// 8-bit display values, sRGB.
struct DisplayImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  // height x width x 3, top row first
};

// Writes them as they are, to a name that is_linear_image() is false for. Throws as write_image() does.
void write_display_image(const std::string& path, const DisplayImage& image, const Metadata& metadata, bool force);

// Red, green and blue as they are in the file, upright (grid/io/picture/picture.h; display images are not linearised),
// one channel as grey. Throws Error for unreadable files and values that are not finite.
Film read_image(const std::string& path);

// The same of files by other programs, with what was assumed of them, one line each: the layer taken, for instance.
struct ImageFile {
  Film film;
  std::vector<std::string> warnings;
};
ImageFile read_image_file(const std::string& path);

}  // namespace ivory
