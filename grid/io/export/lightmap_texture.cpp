#include "grid/io/export/lightmap_texture.h"

#include <algorithm>

#include "grid/base/half.h"
#include "grid/export/texel.h"
#include "grid/io/file.h"
#include "grid/io/ktx/bytes.h"

namespace ivory {

Ktx2Format write_lightmap_texture(const std::string& path, int width, int height, const std::vector<Rgb>& e,
                                  const std::map<std::string, std::string>& notes, bool force) {
  float largest = 0;
  for (const Rgb& texel : e) largest = std::max(largest, max_component(texel));
  constexpr float dim = 0.01F;  // below, halves lose bits
  const bool fits = largest <= largest_half && (largest >= dim || largest == 0);
  Ktx2Texture texture;
  texture.format = fits ? Ktx2Format::rgba16f : Ktx2Format::rgba32f;
  texture.width = width;
  texture.height = height;
  texture.notes = notes;
  std::string& data = texture.levels.emplace_back();
  data.reserve(e.size() * std::size_t(texel_bytes(texture.format)));
  for (const Rgb& texel : e) {
    for (const float channel : {texel.x, texel.y, texel.z, 1.0F}) {
      if (fits) {
        put(data, pack_half(channel));
      } else {
        put_float(data, channel);
      }
    }
  }
  write_file(path, ktx2_bytes(texture, Ktx2Compression::zstd), force);
  return texture.format;
}

}  // namespace ivory
