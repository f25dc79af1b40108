#include "grid/io/picture/picture.h"

#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/io/image_codec.h"
#include "grid/io/picture/formats.h"
#include "grid/io/picture/scan_order.h"

namespace ivory {

namespace {

bool same_word(std::string a, std::string b) {
  for (std::string* s : {&a, &b})
    for (char& c : *s) c = char(std::tolower(static_cast<unsigned char>(c)));
  return a == b;
}

std::string profile_of(const ImageHeader& header) {
  return find_text(header.attributes, "ICCProfile:profile_description").value_or("");
}

bool has_srgb_profile(const ImageHeader& header) { return profile_of(header).find("sRGB") != std::string::npos; }

// What OpenImageIO says of the values: "sRGB", "linear", "Gamma2.2" beside the exact number, another name, or nothing.
void set_transfer(StoredPicture& picture, const std::string& path, const ImageHeader& header) {
  const std::string space = find_text(header.attributes, "oiio:ColorSpace").value_or("");
  const bool integers = header.pixel_type.find("int") != std::string::npos;
  const double gamma = find_number(header.attributes, "oiio:Gamma").value_or(0);
  for (const char* name : {"linear", "scene_linear", "lin_srgb", "lin_rec709"})
    if (same_word(space, name)) return;
  if (same_word(space, "sRGB")) {
    picture.transfer = Transfer::srgb;
  } else if (space.starts_with("Gamma") && gamma > 0 && std::isfinite(gamma)) {
    if (gamma == 1) return;
    picture.transfer = Transfer::power;
    picture.gamma = gamma > 1 ? gamma : 1 / gamma;  // some writers store the encoder's exponent
    picture.color_warnings.push_back(
        fmt::format("says that its values are coded by a power of {:.4g}: they are decoded by it", picture.gamma));
  } else if (space.empty() || same_word(space, "Rec709")) {
    if (!integers) return;
    picture.transfer = Transfer::srgb;
    if (has_srgb_profile(header)) return;
    const std::size_t digits = header.pixel_type.find_first_of("0123456789");
    const std::string bits = digits == std::string::npos ? "32" : header.pixel_type.substr(digits);
    picture.color_warnings.push_back(
        fmt::format("states no colour space for its {} bits a channel: sRGB is assumed", bits));
  } else {
    throw Error(path, "is coded as " + space + ", which ivory does not decode", "convert it to linear OpenEXR");
  }
}

// A profile's own description, where it is not sRGB's.
void note_profile(StoredPicture& picture, const ImageHeader& header) {
  const std::string profile = profile_of(header);
  if (profile.empty() || has_srgb_profile(header)) return;
  picture.color_warnings.push_back(fmt::format(
      "has the colour profile '{}', which is not applied: {} Rec.709 is assumed", profile, transfer_name(picture)));
}

// Colour stored times alpha is divided by it, so that a texel is the same in all formats. Where nothing is left of it,
// black stays.
void divide_by_alpha(float* texel, int colors, float alpha) {
  for (int c = 0; c < colors; ++c) texel[c] = alpha > 0 ? texel[c] / alpha : 0;
}

}  // namespace

void check_claimed_size(const std::string& path, std::int64_t width, std::int64_t height) {
  constexpr double most_pixels_per_byte = 65536;  // black in OpenEXR's large blocks stays far below
  const auto bytes = std::filesystem::file_size(path);
  if (double(width) * double(height) > most_pixels_per_byte * double(bytes))
    throw Error(path, fmt::format("claims {} x {} pixels in {} bytes", width, height, bytes), "export it again");
}

StoredPicture read_other_picture(const std::string& path, const std::string& remedy) {
  std::string cause;
  const std::unique_ptr<OpenImage> image = image_codec().open(path, cause);
  if (!image) throw Error(path, "cannot be read as an image (" + cause + ")", remedy);
  const ImageHeader& header = image->header;
  if (header.depth > 1) throw Error(path, "is a volume, no image", remedy);
  if (header.channels < 1 || header.width < 1 || header.height < 1)
    throw Error(path, "has no colour channels", "give an image with one or three channels");
  check_claimed_size(path, header.width, header.height);

  StoredPicture picture;
  picture.asset = find_text(header.attributes, "ivory:asset").value_or("");
  set_transfer(picture, path, header);
  note_profile(picture, header);
  if (header.format == "png") picture.primaries = png_primaries(path).value_or(Primaries{});
  const int colors = header.channels >= 3 ? 3 : 1;
  const bool alpha = header.alpha_channel == colors && header.alpha_channel < header.channels;
  const int channels = colors + (alpha ? 1 : 0);
  const auto count = std::size_t(header.width) * std::size_t(header.height);
  check_memory(path, double(count) * (4.0 * channels + 2 * sizeof(Rgb)), "scale it down");
  std::vector<float> data(count * std::size_t(channels));
  if (cause = image->read(channels, PixelType::float32, data.data()); !cause.empty())
    throw Error(path, "is damaged (" + cause + ")", "export it again");

  std::size_t translucent = 0;
  picture.texels.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    float* texel = data.data() + i * std::size_t(channels);
    if (alpha && texel[colors] != 1) {
      ++translucent;
      if (header.premultiplied) divide_by_alpha(texel, colors, texel[colors]);
    }
    picture.texels[i] = colors == 3 ? Rgb(texel[0], texel[1], texel[2]) : Rgb(texel[0], texel[0], texel[0]);
  }
  if (translucent > 0)
    picture.warnings.push_back(fmt::format(
        "has alpha below 1 in {} of {} texels: it is ignored, their colour counts in full", translucent, count));

  picture.width = header.width;
  picture.height = header.height;
  const auto orientation = find_int(header.attributes, "Orientation").value_or(1);
  const auto order = scan_order_of_exif(int(orientation));
  if (order && *order != ScanOrder{}) {
    if (order->columns) std::swap(picture.width, picture.height);
    picture.texels = upright(std::move(picture.texels), picture.width, picture.height, *order);
    picture.warnings.push_back(fmt::format("is turned upright, as its orientation {} says", orientation));
  }
  return picture;
}

StoredPicture read_picture(const std::string& path, const std::string& remedy) {
  if (is_exr_picture(path)) return read_exr_picture(path, remedy);
  if (is_radiance_picture(path)) return read_radiance_picture(path, remedy);
  return read_other_picture(path, remedy);
}

float linear_from_stored(const StoredPicture& picture, float value) {
  switch (picture.transfer) {
    case Transfer::srgb:
      return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
    case Transfer::power:
      return value <= 0 ? value : float(std::pow(double(value), picture.gamma));
    default:
      return value;
  }
}

std::string transfer_name(const StoredPicture& picture) {
  if (picture.transfer == Transfer::linear) return "linear";
  return picture.transfer == Transfer::srgb ? "sRGB" : fmt::format("power {:.4g}", picture.gamma);
}

}  // namespace ivory
