#include "grid/io/environment.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/env/irradiance.h"
#include "grid/io/picture/picture.h"
#include "grid/io/picture/primaries.h"

namespace ivory {

namespace {

// Of the light; what compression leaves below zero is far less.
constexpr double most_below_zero = 0.01;

std::string size_text(const StoredPicture& picture) {
  return "is " + std::to_string(picture.width) + " x " + std::to_string(picture.height);
}

EnvironmentLayout find_layout(const std::string& path, const StoredPicture& picture,
                              std::optional<EnvironmentLayout> asked) {
  if (picture.width * std::int64_t(picture.height) < 2)
    throw Error(path, size_text(picture) + ", too small for any layout of the sphere", "give an environment map");
  std::string who = "the layout given";
  if (!asked) {
    asked = picture.layout;
    who = "its envmap attribute";
  }
  if (asked) {
    if (!fits(*asked, picture.width, picture.height)) {
      throw Error(path,
                  size_text(picture) + ", but " + who + " is " + std::string(name_of(*asked)) + ", which is " +
                      std::string(required_shape(*asked)),
                  "convert it, or give the layout it has");
    }
    return *asked;
  }
  const auto layout = layout_of_aspect(picture.width, picture.height);
  if (!layout) {
    throw Error(path,
                size_text(picture) +
                    ", which is no layout of the sphere: 2:1 lat-long, 1:1 angular, 3:4 or 4:3 cross, 1:6 or 6:1 faces",
                "convert it to one of these");
  }
  return *layout;
}

// Stored values to linear ones.
void decode(const std::string& path, StoredPicture& picture) {
  for (std::size_t i = 0; i < picture.texels.size(); ++i) {
    for (unsigned c = 0; c < 3; ++c) {
      float& value = picture.texels[i][c];
      if (!std::isfinite(value)) {
        throw Error(path,
                    fmt::format("holds a value that is not finite at column {}, row {}", i % std::size_t(picture.width),
                                i / std::size_t(picture.width)),
                    "mend the image or clamp it");
      }
      value = linear_from_stored(picture, value);
    }
  }
}

EnvironmentImage in_layout(EnvironmentLayout layout, StoredPicture& picture) {
  switch (layout) {
    case EnvironmentLayout::latlong:
      return {layout, EnvironmentMap{picture.width, picture.height, std::move(picture.texels)}};
    case EnvironmentLayout::angular:
      return {layout, AngularMap{picture.width, std::move(picture.texels)}};
    default:
      return {layout, cube_from_picture(layout, picture.texels, picture.width, picture.height)};
  }
}

std::vector<Rgb>& texels_of(EnvironmentImage& image) {
  if (auto* map = std::get_if<EnvironmentMap>(&image.map)) return map->radiance;
  if (auto* cube = std::get_if<CubeMap>(&image.map)) return cube->texels;
  return std::get<AngularMap>(image.map).texels;
}

double sum_of(const V3d& v) { return v.x + v.y + v.z; }

std::string texel_count(std::size_t count) { return fmt::format("{} texel{}", count, count == 1 ? "" : "s"); }

// Where the sphere is shown: corners of a cross or an angular map count for nothing.
void clamp_below_zero(const std::string& path, LoadedEnvironment& loaded) {
  std::vector<Rgb>& texels = texels_of(loaded.image);
  const auto below_zero = [](const Rgb& t) { return t.x < 0 || t.y < 0 || t.z < 0; };
  const auto count = std::size_t(std::count_if(texels.begin(), texels.end(), below_zero));
  if (count == 0) return;
  const double before = sum_of(radiance_moments(loaded.image).total);
  for (Rgb& texel : texels)
    for (unsigned c = 0; c < 3; ++c) texel[c] = std::max(0.0F, texel[c]);
  const double after = sum_of(radiance_moments(loaded.image).total);
  const double share = after > before ? (after - before) / after : 0;  // infinite where nothing is above zero
  if (share > most_below_zero) {
    throw Error(path,
                fmt::format("holds values below zero in {}, {:.3g} % of its light", texel_count(count), 100 * share),
                "clamp it at zero where that is meant");
  }
  loaded.warnings.push_back(
      fmt::format("{}: {} below zero, {:.2g} % of the light, count as 0", path, texel_count(count), 100 * share));
}

// From the file's primaries and its nits to nits of Rec.709.
void bring_to_nits(const std::string& path, const StoredPicture& picture, LoadedEnvironment& loaded) {
  std::vector<Rgb>& texels = texels_of(loaded.image);
  if (!is_rec709(picture.primaries)) {
    Imath::M33d m;
    try {
      m = to_rec709(picture.primaries);
    } catch (const std::invalid_argument& error) {
      throw Error(path, std::string("names primaries of no colour space (") + error.what() + ")",
                  "convert it to Rec.709");
    }
    std::size_t outside = 0;
    for (Rgb& texel : texels) {
      const V3d color = transformed(m, V3d(texel));
      // Rounding of white and grey is none.
      const double least = std::min({color.x, color.y, color.z});
      if (least < -1e-4 * std::max({color.x, color.y, color.z})) ++outside;
      texel = within_gamut(color);
    }
    const Primaries& p = picture.primaries;
    loaded.warnings.push_back(fmt::format(
        "{}: colours are converted to Rec.709 from primaries {:.4g},{:.4g} {:.4g},{:.4g} {:.4g},{:.4g}, "
        "white {:.4g},{:.4g}{}",
        path, p.red.x, p.red.y, p.green.x, p.green.y, p.blue.x, p.blue.y, p.white.x, p.white.y,
        outside == 0 ? "" : fmt::format(": {} too saturated for it keep their luminance alone", texel_count(outside))));
  }
  if (picture.nits == 1) return;
  for (Rgb& texel : texels)
    for (unsigned c = 0; c < 3; ++c) texel[c] = float(texel[c] * picture.nits);
  loaded.warnings.push_back(fmt::format(
      "{}: its whiteLuminance says that 1 stands for {:.6g} nits: values are multiplied by it", path, picture.nits));
}

}  // namespace

LoadedEnvironment load_environment_image(const std::string& path, std::optional<EnvironmentLayout> asked) {
  StoredPicture picture = read_picture(path, "give a lat-long EXR, HDR or other image file");
  if (!picture.asset.empty())
    throw Error(path, "is baked (" + picture.asset + "), no environment map", "give the map that it was baked from");
  const EnvironmentLayout layout = find_layout(path, picture, asked);
  // The texels once more in their layout, and sampled through a table and its weights.
  check_memory(path, double(picture.texels.size()) * (2 * sizeof(Rgb) + 8 + 16), "scale it down");
  decode(path, picture);

  LoadedEnvironment loaded{in_layout(layout, picture), {}, {}};
  for (const auto* warnings : {&picture.warnings, &picture.color_warnings})
    for (const std::string& warning : *warnings) loaded.warnings.push_back(path + ": " + warning);
  clamp_below_zero(path, loaded);
  bring_to_nits(path, picture, loaded);
  for (const Rgb& texel : texels_of(loaded.image)) {
    if (!std::isfinite(texel.x + texel.y + texel.z))
      throw Error(path, "holds values that in nits are beyond all numbers", "scale it down");
  }

  if (picture.transfer != Transfer::linear || !is_rec709(picture.primaries)) {
    loaded.facts["environment_color_space"] =
        transfer_name(picture) + (is_rec709(picture.primaries) ? " Rec.709" : " of its own primaries");
  }
  if (!picture.layer.empty()) loaded.facts["environment_layer"] = picture.layer;
  return loaded;
}

EnvironmentMap load_environment(const std::string& path, std::optional<EnvironmentLayout> layout) {
  return to_latlong(load_environment_image(path, layout).image);
}

}  // namespace ivory
