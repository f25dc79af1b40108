#include "grid/io/export/filament.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "grid/export/dialect.h"
#include "grid/export/texel.h"
#include "grid/io/file.h"
#include "grid/io/ktx/ktx1.h"

namespace ivory {

namespace {
constexpr int cube_size = 16;  // E has no detail that more would show
}

void write_filament_text(const std::string& path, const DistantLight& light, bool force) {
  constexpr std::array<const char*, 9> names{"L00", "L1-1", "L10", "L11", "L2-2", "L2-1", "L20", "L21", "L22"};
  const std::array<V3d, 9> values = in_dialect(light.sh, Sh9Dialect::filament);
  std::string out;
  for (std::size_t i = 0; i < 9; ++i) {
    out += fmt::format("({:18.15f}, {:18.15f}, {:18.15f}); // {}, irradiance, pre-scaled base\n", values[i].x,
                       values[i].y, values[i].z, names[i]);
  }
  write_file(path, out, force);
}

float write_filament_ktx(const std::string& path, const DistantLight& light, bool force) {
  std::string sh;
  for (const V3d& v : in_dialect(light.sh, Sh9Dialect::filament)) sh += fmt::format("{} {} {}\n", v.x, v.y, v.z);
  std::vector<std::vector<Rgb>> levels;
  float largest = 0;
  for (int size = cube_size; size >= 1; size /= 2) {
    // Filament samples its reflections in world directions as they are.
    levels.push_back(gpu_cube(size, [&](const V3f& d) { return light.e(d) / pi; }));
    for (const Rgb& texel : levels.back()) largest = std::max(largest, max_component(texel));
  }
  const float scale = largest > largest_float11 ? std::exp2(std::ceil(std::log2(largest / largest_float11))) : 1;
  for (std::vector<Rgb>& level : levels)
    for (Rgb& texel : level) texel /= scale;
  write_file(path, ktx1_cube_bytes(cube_size, levels, {{"sh", sh}}), force);
  return scale;
}

}  // namespace ivory
