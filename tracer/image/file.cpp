#include "tracer/image/file.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "grid/base/error.h"
#include "grid/io/file.h"
#include "grid/io/image_codec.h"
#include "grid/io/picture/picture.h"

namespace ivory {

namespace {

// IEC 61966-2-1.
float srgb_from_linear(float x) { return x <= 0.0031308F ? 12.92F * x : 1.055F * std::pow(x, 1.0F / 2.4F) - 0.055F; }

}  // namespace

void check_image_name(const std::string& path) {
  if (!image_codec().can_write(path))
    throw Error(path, "has no extension of an image format that ivory writes", "end it in .exr or .png");
}

bool is_linear_image(const std::string& path) {
  const std::string extension = lower_extension(path);
  for (const char* linear : {".exr", ".hdr", ".tif", ".tiff"}) {
    if (extension == linear) return true;
  }
  return false;
}

namespace {

// Channels from `pixels`, whose values are of the type `type`.
void write_pixels(const std::string& path, int width, int height, PixelType type, const void* pixels,
                  const Metadata& metadata, bool force, const std::vector<std::string>& channels = {"R", "G", "B"}) {
  check_image_name(path);
  const ImageToWrite image{width, height, type, pixels, is_linear_image(path), metadata, channels};
  std::string cause;
  const std::vector<std::uint8_t> bytes = image_codec().encode(path, image, cause);
  if (bytes.empty()) throw Error(path, "cannot be written (" + cause + ")", "end it in .exr or .png");
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, force);
}

}  // namespace

std::vector<float> display_values(const Film& film, float exposure_stops) {
  std::vector<float> display;
  const float scale = std::exp2(exposure_stops);
  display.reserve(film.pixels.size() * 3);
  for (const Rgb& pixel : film.pixels) {
    const Rgb mapped = tone_map(pixel * scale);
    for (int c = 0; c < 3; ++c) display.push_back(srgb_from_linear(std::clamp(mapped[c], 0.0F, 1.0F)));
  }
  return display;
}

void write_image(const std::string& path, const Film& film, float exposure_stops, const Metadata& metadata, bool force,
                 const std::vector<ImageChannel>& more) {
  if (!more.empty() && lower_extension(path) == ".exr") {
    std::vector<std::string> channels{"R", "G", "B"};
    for (const ImageChannel& channel : more) channels.push_back(channel.name);
    std::vector<float> values;
    values.reserve(film.pixels.size() * channels.size());
    for (std::size_t i = 0; i < film.pixels.size(); ++i) {
      for (int c = 0; c < 3; ++c) values.push_back(film.pixels[i][c]);
      for (const ImageChannel& channel : more) values.push_back(channel.values[i]);
    }
    write_pixels(path, film.width, film.height, PixelType::float32, values.data(), metadata, force, channels);
    return;
  }
  if (is_linear_image(path)) {
    write_pixels(path, film.width, film.height, PixelType::float32, &film.pixels.front().x, metadata, force);
    return;
  }
  const std::vector<float> display = display_values(film, exposure_stops);
  write_pixels(path, film.width, film.height, PixelType::float32, display.data(), metadata, force);
}

void write_display_image(const std::string& path, const DisplayImage& image, const Metadata& metadata, bool force) {
  write_pixels(path, image.width, image.height, PixelType::uint8, image.rgb.data(), metadata, force);
}

ImageFile read_image_file(const std::string& path) {
  StoredPicture picture = read_picture(path, "give an EXR or other image file");
  for (const Rgb& texel : picture.texels) {
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(texel[c])) throw Error(path, "holds values that are not finite", "render it again");
  }
  ImageFile file;
  file.film.width = picture.width;
  file.film.height = picture.height;
  file.film.pixels = std::move(picture.texels);
  for (const std::string& warning : picture.warnings) file.warnings.push_back(path + ": " + warning);
  return file;
}

Film read_image(const std::string& path) { return read_image_file(path).film; }

}  // namespace ivory
