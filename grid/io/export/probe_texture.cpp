#include "grid/io/export/probe_texture.h"

#include <algorithm>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/export/texel.h"
#include "grid/io/file.h"
#include "grid/io/ktx/bytes.h"

namespace ivory {

void check_texture_size(const Atlas& atlas) {
  constexpr int largest = 2048;
  const int most = std::max({atlas.size.x, atlas.size.y, atlas.size.z});
  if (most > largest) {
    throw ParameterError("voxel_size", "the texture would have " + std::to_string(most) +
                                           " texels along a side, and 2048 is what all graphics cards take; ask for a "
                                           "larger one");
  }
}

void write_atlas(const std::string& path, const Atlas& atlas, Ktx2Format format,
                 const std::map<std::string, std::string>& notes, bool force) {
  Ktx2Texture texture;
  texture.format = format;
  texture.width = atlas.size.x;
  texture.height = atlas.size.y;
  texture.depth = atlas.size.z;
  texture.notes = notes;
  std::string& data = texture.levels.emplace_back();
  data.reserve(atlas.texels.size() * std::size_t(texel_bytes(format)));
  for (const V4f& texel : atlas.texels) {
    if (format == Ktx2Format::e5b9g9r9) {
      put(data, pack_shared_exponent(Rgb(texel.x, texel.y, texel.z)));
      continue;
    }
    for (const float channel : {texel.x, texel.y, texel.z, texel.w}) {
      if (format == Ktx2Format::rgba16f) {
        put(data, pack_half(channel));
      } else {
        put_float(data, channel);
      }
    }
  }
  write_file(path, ktx2_bytes(texture, Ktx2Compression::zstd), force);
}

std::string beside(const std::string& path, const std::string& extension) {
  return std::filesystem::path(path).replace_extension(extension).string();
}

namespace {

template <typename Vector>
Json list_of(const Vector& v) {
  return {v.x, v.y, v.z};
}

}  // namespace

Json probe_json(const ProbeVolume& volume, const ProbeExport& about, const std::string& texture) {
  const GridFrame& frame = volume.frame;
  Json json{{"format", "ivory probe volume"},
            {"format_version", 1},
            {"ivory_version", IVORY_VERSION},
            {"target", about.target},
            {"texture", std::filesystem::path(texture).filename().string()},
            {"size", list_of(frame.size)},
            {"center_m", list_of(volume.center_m())},
            {"extent_m", list_of(volume.extent_m())},
            {"spacing_m", list_of(frame.spacing_m)},
            {"first_probe_m", list_of(to_world(frame.origin_m, volume.anchor_m))},
            {"axes", Json::array()},
            {"light", name_of(about.light)},
            {"resampled", volume.resampled},
            {"probes",
             {{"measured", volume.count(ProbeState::measured)},
              {"filled", volume.count(ProbeState::filled)},
              {"dark", volume.count(ProbeState::dark)}}},
            {"thin_walls", about.thin_walls},
            {"loss",
             {{"in_the_open", about.loss.in_the_open},
              {"on_surfaces", about.loss.on_surfaces},
              {"points_in_the_open", about.loss.points_in_the_open},
              {"points_on_surfaces", about.loss.points_on_surfaces},
              {"measure", "RMS of what the reader shows less the grid's E, over the grid's mean E"}}},
            {"source", to_json(about.source)}};
  for (int axis = 0; axis < 3; ++axis) {
    json["axes"].push_back(
        {frame.local_to_world[axis][0], frame.local_to_world[axis][1], frame.local_to_world[axis][2]});
  }
  return json;
}

}  // namespace ivory
