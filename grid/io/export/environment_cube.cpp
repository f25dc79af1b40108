#include "grid/io/export/environment_cube.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "grid/base/half.h"
#include "grid/export/texel.h"
#include "grid/io/file.h"
#include "grid/io/ktx/bytes.h"
#include "grid/io/ktx/ktx2.h"

namespace ivory {

EnvironmentCube write_bevy_cube(const std::string& path, const DistantLight& light, bool force) {
  constexpr int size_of_nine = 32;  // faces for nine coefficients: bilinear look-ups are off by 1e-3 at most
  EnvironmentCube out;
  out.size = light.size > 0 ? light.size : size_of_nine;
  // environment_map.wesl: the diffuse map is sampled at (n.x, n.y, -n.z), and holds what Lambert reflects of it.
  const std::vector<Rgb> texels = gpu_cube(out.size, [&](const V3f& d) { return light.e(V3f(d.x, d.y, -d.z)) / pi; });
  float largest = 0;
  for (const Rgb& texel : texels) largest = std::max(largest, max_component(texel));
  constexpr float dim = 0.01F;  // below it halves would lose bits
  if (largest > largest_half || (largest > 0 && largest < dim)) out.intensity = half_scale(largest);
  Ktx2Texture texture;
  texture.format = Ktx2Format::rgba16f;
  texture.width = texture.height = out.size;
  texture.faces = 6;
  texture.levels.emplace_back();
  for (const Rgb& texel : texels) {
    for (const float value : {texel.x / out.intensity, texel.y / out.intensity, texel.z / out.intensity, 1.0F})
      put(texture.levels[0], pack_half(value));
  }
  texture.notes = {
      {"ivory", "irradiance / pi / intensity, for EnvironmentMapLight { diffuse_map, specular_map, intensity: " +
                    fmt::format("{}", out.intensity) + " }"}};
  write_file(path, ktx2_bytes(texture, Ktx2Compression::zstd), force);
  return out;
}

}  // namespace ivory
