#include "grid/io/environment.h"

#include <cmath>
#include <memory>
#include <utility>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/io/image_codec.h"

namespace ivory {

namespace {

// IEC 61966-2-1.
float linear_from_srgb(float x) { return x <= 0.04045F ? x / 12.92F : std::pow((x + 0.055F) / 1.055F, 2.4F); }

std::string size_text(const ImageHeader& header) {
  return "is " + std::to_string(header.width) + " x " + std::to_string(header.height);
}

EnvironmentLayout find_layout(const std::string& path, const ImageHeader& header,
                              std::optional<EnvironmentLayout> asked) {
  if (header.width <= 0 || header.height <= 0 || header.width * std::int64_t(header.height) < 2)
    throw Error(path, size_text(header) + ", too small for any layout of the sphere", "give an environment map");
  std::string who = "the layout given";
  if (!asked) {
    const std::string attribute = find_text(header.attributes, "textureformat").value_or("");
    who = "its envmap attribute";
    if (attribute == "CubeFace Environment") asked = EnvironmentLayout::cube;
    if (attribute == "LatLong Environment") asked = EnvironmentLayout::latlong;
  }
  if (asked) {
    if (!fits(*asked, header.width, header.height)) {
      throw Error(path,
                  size_text(header) + ", but " + who + " is " + std::string(name_of(*asked)) + ", which is " +
                      std::string(required_shape(*asked)),
                  "convert it, or give the layout it has");
    }
    return *asked;
  }
  const auto layout = layout_of_aspect(header.width, header.height);
  if (!layout) {
    throw Error(path,
                size_text(header) +
                    ", which is no layout of the sphere: 2:1 lat-long, 1:1 angular, 3:4 or 4:3 cross, 1:6 or 6:1 faces",
                "convert it to one of these");
  }
  return *layout;
}

}  // namespace

EnvironmentImage load_environment_image(const std::string& path, std::optional<EnvironmentLayout> asked) {
  std::string cause;
  const std::unique_ptr<OpenImage> image = image_codec().open(path, cause);
  if (!image) throw Error(path, "cannot be read as an image", "give a lat-long EXR, HDR or other image file");
  const ImageHeader& header = image->header;
  if (header.depth > 1) throw Error(path, "is a volume, no image", "give a lat-long EXR, HDR or other image file");
  if (header.channels < 1) throw Error(path, "has no colour channels", "give an image with one or three channels");
  if (const std::string asset = find_text(header.attributes, "ivory:asset").value_or(""); !asset.empty())
    throw Error(path, "is baked (" + asset + "), no environment map", "give the map that it was baked from");
  const EnvironmentLayout layout = find_layout(path, header, asked);
  const auto texels = std::size_t(header.width) * std::size_t(header.height);
  const int channels = header.channels >= 3 ? 3 : 1;
  // Read as floats, kept as RGB, and sampled through a table and its weights.
  check_memory(path, double(texels) * (4.0 * channels + 12 + 8 + 16), "scale it down");
  std::vector<float> data(texels * std::size_t(channels));
  std::vector<Rgb> radiance(texels);
  if (cause = image->read(channels, PixelType::float32, data.data()); !cause.empty())
    throw Error(path, "is damaged (" + cause + ")", "export it again");

  // PNG, JPEG and the like say that they are sRGB-coded.
  const bool srgb = find_text(header.attributes, "oiio:ColorSpace").value_or("") == "sRGB";
  for (std::size_t i = 0; i < texels; ++i) {
    const float* texel = data.data() + i * std::size_t(channels);
    radiance[i] = channels == 3 ? Rgb(texel[0], texel[1], texel[2]) : Rgb(texel[0], texel[0], texel[0]);
    for (int c = 0; c < 3; ++c) {
      const float value = radiance[i][c];
      const auto at = [&] {
        return " at column " + std::to_string(i % std::size_t(header.width)) + ", row " +
               std::to_string(i / std::size_t(header.width));
      };
      if (!std::isfinite(value))
        throw Error(path, "holds a value that is not finite" + at(), "mend the image or clamp it");
      if (value < 0) throw Error(path, "holds a negative value" + at(), "clamp the image at zero");
      if (srgb) radiance[i][c] = linear_from_srgb(value);
    }
  }
  switch (layout) {
    case EnvironmentLayout::latlong:
      return {layout, EnvironmentMap{header.width, header.height, std::move(radiance)}};
    case EnvironmentLayout::angular:
      return {layout, AngularMap{header.width, std::move(radiance)}};
    default:
      return {layout, cube_from_picture(layout, radiance, header.width, header.height)};
  }
}

EnvironmentMap load_environment(const std::string& path, std::optional<EnvironmentLayout> layout) {
  return to_latlong(load_environment_image(path, layout));
}

}  // namespace ivory
