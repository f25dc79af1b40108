#include "tracer/image/file.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/io/file.h"
#include "grid/io/image_codec.h"

namespace ivory {

namespace {

// IEC 61966-2-1.
float srgb_from_linear(float x) { return x <= 0.0031308F ? 12.92F * x : 1.055F * std::pow(x, 1.0F / 2.4F) - 0.055F; }

}  // namespace

void check_image_name(const std::string& path) {
  if (!image_codec().can_write(path))
    throw Error(path, "has no extension that names an image format", "end it in .exr or .png");
}

bool is_linear_image(const std::string& path) {
  const std::string extension = lower_extension(path);
  for (const char* linear : {".exr", ".hdr", ".tif", ".tiff"}) {
    if (extension == linear) return true;
  }
  return false;
}

namespace {

// Three channels from `pixels`, whose values are of the type `type`.
void write_pixels(const std::string& path, int width, int height, PixelType type, const void* pixels,
                  const Metadata& metadata, bool force) {
  PendingFile pending(path, force);
  check_image_name(path);
  const ImageToWrite image{width, height, type, pixels, is_linear_image(path), metadata};
  if (const std::string cause = image_codec().write(pending.temporary(), image); !cause.empty())
    throw Error(path, "cannot be written (" + cause + ")", "check the disk and the extension");
  pending.commit();
}

}  // namespace

void write_image(const std::string& path, const Film& film, float exposure_stops, const Metadata& metadata,
                 bool force) {
  if (is_linear_image(path)) {
    write_pixels(path, film.width, film.height, PixelType::float32, &film.pixels.front().x, metadata, force);
    return;
  }
  std::vector<float> display;
  const float scale = std::exp2(exposure_stops);
  display.reserve(film.pixels.size() * 3);
  for (const Rgb& pixel : film.pixels) {
    const Rgb mapped = tone_map(pixel * scale);
    for (int c = 0; c < 3; ++c) display.push_back(srgb_from_linear(std::clamp(mapped[c], 0.0F, 1.0F)));
  }
  write_pixels(path, film.width, film.height, PixelType::float32, display.data(), metadata, force);
}

void write_display_image(const std::string& path, const DisplayImage& image, const Metadata& metadata, bool force) {
  write_pixels(path, image.width, image.height, PixelType::uint8, image.rgb.data(), metadata, force);
}

Film read_image(const std::string& path) {
  std::string cause;
  const std::unique_ptr<OpenImage> image = image_codec().open(path, cause);
  if (!image) throw Error(path, "cannot be read as an image", "give an EXR or other image file");
  const ImageHeader& header = image->header;
  if (header.depth > 1) throw Error(path, "is a volume, no image", "give an EXR or other image file");
  const int channels = header.channels >= 3 ? 3 : 1;
  Film film;
  film.width = header.width;
  film.height = header.height;
  const auto count = std::size_t(header.width) * std::size_t(header.height);
  check_memory(path, double(count) * (4.0 * channels + 12), "scale it down");
  std::vector<float> data(count * std::size_t(channels));
  film.pixels.resize(count);
  if (cause = image->read(channels, PixelType::float32, data.data()); !cause.empty())
    throw Error(path, "is damaged (" + cause + ")", "write it again");
  for (std::size_t i = 0; i < count; ++i) {
    const float* p = data.data() + i * std::size_t(channels);
    film.pixels[i] = channels == 3 ? Rgb(p[0], p[1], p[2]) : Rgb(p[0], p[0], p[0]);
    for (int c = 0; c < 3; ++c) {
      if (!std::isfinite(film.pixels[i][c])) throw Error(path, "holds values that are not finite", "render it again");
    }
  }
  return film;
}

}  // namespace ivory
