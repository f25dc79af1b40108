#include "tracer/environment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <OpenImageIO/imageio.h>

#include "grid/cube_from_latlong.h"
#include "grid/error.h"
#include "grid/memory.h"

namespace ivory {

namespace {

// IEC 61966-2-1.
float linear_from_srgb(float x) { return x <= 0.04045F ? x / 12.92F : std::pow((x + 0.055F) / 1.055F, 2.4F); }

}  // namespace

EnvironmentMap load_environment(const std::string& path) {
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
  if (!input) {
    OIIO::geterror();  // OpenImageIO prints an unread error when the program ends
    throw Error(path, "cannot be read as an image", "give a lat-long EXR, HDR or other image file");
  }
  const OIIO::ImageSpec spec = input->spec();
  if (spec.nchannels < 1)
    throw Error(path, "has no colour channels", "give a lat-long image with one or three channels");
  if (spec.height <= 0 || spec.width != 2 * spec.height)
    throw Error(path,
                "is " + std::to_string(spec.width) + " x " + std::to_string(spec.height) +
                    ", a lat-long map is twice as wide as high",
                "convert it to lat-long first");
  const auto texels = std::size_t(spec.width) * std::size_t(spec.height);
  const int channels = spec.nchannels >= 3 ? 3 : 1;
  // Read as floats, kept as RGB, and sampled through a table and its weights.
  check_memory(path, double(texels) * (4.0 * channels + 12 + 8 + 16), "scale it down");
  std::vector<float> data(texels * std::size_t(channels));
  EnvironmentMap map;
  map.radiance.resize(texels);
  if (!input->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, data.data()))
    throw Error(path, "is damaged (" + input->geterror() + ")", "export it again");

  map.width = spec.width;
  map.height = spec.height;
  // PNG, JPEG and the like say that they are sRGB-coded.
  const bool srgb = spec.get_string_attribute("oiio:ColorSpace") == "sRGB";
  for (std::size_t i = 0; i < texels; ++i) {
    const float* texel = data.data() + i * std::size_t(channels);
    map.radiance[i] = channels == 3 ? Rgb(texel[0], texel[1], texel[2]) : Rgb(texel[0], texel[0], texel[0]);
    for (int c = 0; c < 3; ++c) {
      const float value = map.radiance[i][c];
      const auto at = [&] {
        return " at column " + std::to_string(i % std::size_t(spec.width)) + ", row " +
               std::to_string(i / std::size_t(spec.width));
      };
      if (!std::isfinite(value))
        throw Error(path, "holds a value that is not finite" + at(), "mend the image or clamp it");
      if (value < 0) throw Error(path, "holds a negative value" + at(), "clamp the image at zero");
      if (srgb) map.radiance[i][c] = linear_from_srgb(value);
    }
  }
  return map;
}

Rgb eval(const EnvironmentMap& environment, const V3f& w) {
  // atan2 for the polar angle too: acos(y) has no digits left near the poles.
  const float u = 0.5F + std::atan2(-w.x, w.z) / (2 * pi);
  const float v = std::atan2(std::sqrt(w.x * w.x + w.z * w.z), w.y) / pi;
  const int column = std::clamp(int(u * float(environment.width)), 0, environment.width - 1);
  const int row = std::clamp(int(v * float(environment.height)), 0, environment.height - 1);
  return environment.radiance[std::size_t(row) * std::size_t(environment.width) + std::size_t(column)];
}

CubeMap cube_from_environment(const EnvironmentMap& environment, int size) {
  return cube_from_latlong(environment.radiance, environment.width, environment.height, size);
}

}  // namespace ivory
