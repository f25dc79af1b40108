#include "tracer/image/file.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <type_traits>
#include <variant>
#include <vector>

#include <OpenImageIO/imageio.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/io/file.h"

namespace ivory {

namespace {

// IEC 61966-2-1.
float srgb_from_linear(float x) { return x <= 0.0031308F ? 12.92F * x : 1.055F * std::pow(x, 1.0F / 2.4F) - 0.055F; }

void add_metadata(OIIO::ImageSpec& spec, const Metadata& metadata) {
  for (const auto& [key, value] : metadata) {
    const std::string attribute = "ivory:" + key;
    std::visit(
        [&](const auto& v) {
          using T = std::decay_t<decltype(v)>;
          if constexpr (std::is_same_v<T, std::string>) {
            spec.attribute(attribute, v);
          } else if constexpr (std::is_same_v<T, double>) {
            spec.attribute(attribute, float(v));
          } else if (v >= std::numeric_limits<int>::min() && v <= std::numeric_limits<int>::max()) {
            spec.attribute(attribute, int(v));
          } else {
            spec.attribute(attribute, std::to_string(v));  // formats keep 32-bit integers only
          }
        },
        value);
  }
}

// A writer for the format that the name's extension stands for.
std::unique_ptr<OIIO::ImageOutput> create_output(const std::string& path) {
  std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(path);
  if (!output) {
    OIIO::geterror();  // OpenImageIO prints an unread error when the program ends
    throw Error(path, "has no extension that names an image format", "end it in .exr or .png");
  }
  return output;
}

}  // namespace

void check_image_name(const std::string& path) { create_output(path); }

bool is_linear_image(const std::string& path) {
  const std::string extension = lower_extension(path);
  for (const char* linear : {".exr", ".hdr", ".tif", ".tiff"}) {
    if (extension == linear) return true;
  }
  return false;
}

namespace {

// Three channels from `pixels`, whose values are of the type `from`.
void write_pixels(const std::string& path, int width, int height, OIIO::TypeDesc from, const void* pixels,
                  const Metadata& metadata, bool force) {
  PendingFile pending(path, force);
  const std::unique_ptr<OIIO::ImageOutput> output = create_output(path);
  const bool linear = is_linear_image(path);
  OIIO::ImageSpec spec(width, height, 3, linear ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", linear ? "linear" : "sRGB");
  if (lower_extension(path) == ".exr") spec.attribute("compression", "zip");
  // OpenImageIO would store the time of day: the same command is to give the same bytes.
  spec.attribute("DateTime", "");
  add_metadata(spec, metadata);
  if (!output->open(pending.temporary(), spec) || !output->write_image(from, pixels) || !output->close())
    throw Error(path, "cannot be written (" + output->geterror() + ")", "check the disk and the extension");
  pending.commit();
}

}  // namespace

void write_image(const std::string& path, const Film& film, float exposure_stops, const Metadata& metadata,
                 bool force) {
  if (is_linear_image(path)) {
    write_pixels(path, film.width, film.height, OIIO::TypeDesc::FLOAT, &film.pixels.front().x, metadata, force);
    return;
  }
  std::vector<float> display;
  const float scale = std::exp2(exposure_stops);
  display.reserve(film.pixels.size() * 3);
  for (const Rgb& pixel : film.pixels) {
    const Rgb mapped = tone_map(pixel * scale);
    for (int c = 0; c < 3; ++c) display.push_back(srgb_from_linear(std::clamp(mapped[c], 0.0F, 1.0F)));
  }
  write_pixels(path, film.width, film.height, OIIO::TypeDesc::FLOAT, display.data(), metadata, force);
}

void write_display_image(const std::string& path, const DisplayImage& image, const Metadata& metadata, bool force) {
  write_pixels(path, image.width, image.height, OIIO::TypeDesc::UINT8, image.rgb.data(), metadata, force);
}

Film read_image(const std::string& path) {
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
  if (!input) {
    OIIO::geterror();
    throw Error(path, "cannot be read as an image", "give an EXR or other image file");
  }
  const OIIO::ImageSpec spec = input->spec();
  if (spec.depth > 1) throw Error(path, "is a volume, no image", "give an EXR or other image file");
  const int channels = spec.nchannels >= 3 ? 3 : 1;
  Film film;
  film.width = spec.width;
  film.height = spec.height;
  const auto count = std::size_t(spec.width) * std::size_t(spec.height);
  check_memory(path, double(count) * (4.0 * channels + 12), "scale it down");
  std::vector<float> data(count * std::size_t(channels));
  film.pixels.resize(count);
  if (!input->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, data.data()))
    throw Error(path, "is damaged (" + input->geterror() + ")", "write it again");
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
