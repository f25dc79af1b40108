#include "runtime/assets/difmap.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "grid/base/half.h"
#include "grid/base/placement.h"
#include "grid/io/difmap.h"
#include "runtime/gl/check.h"

namespace ivory {

GpuDifMap upload(const DifMap& map, const DifMapUploadParams& params, const std::string& what) {
  gl::require_context();
  const CubeMap& e = map.e;
  GpuDifMap out;
  if (params.half_floats) {
    float largest = 0;
    for (const Rgb& texel : e.texels) largest = std::max(largest, max_component(texel));
    out.scale = half_scale(largest);
  }
  // See grid/env/cube_map.h: OpenGL shows the faces from outside.
  std::vector<Rgb> texels;
  texels.reserve(e.texels.size());
  for (int face = 0; face < cube_faces; ++face) {
    const bool vertical = face == 2 || face == 3;
    for (int row = 0; row < e.size; ++row) {
      for (int column = 0; column < e.size; ++column) {
        const int from_row = vertical ? e.size - 1 - row : row;
        const int from_column = vertical ? column : e.size - 1 - column;
        texels.push_back(e.texels[cube_index(e.size, face, from_row, from_column)] / out.scale);
      }
    }
  }
  const gl::Format format = params.half_floats ? gl::Format::rgb16f : gl::Format::rgb32f;
  out.e = gl::make_texture_cube(what, format, e.size, texels.data(), gl::Filter::linear);
  return out;
}

GpuDifMap load_difmap(const std::string& path, const DifMapUploadParams& params) {
  return upload(read_difmap(path), params, path);
}

int bind(const GpuDifMap& map, gl::Program& program, int first_unit) {
  IVORY_GL(glEnable, GL_TEXTURE_CUBE_MAP_SEAMLESS);
  gl::bind(map.e, first_unit);
  program.set("ivory_difmap_e", first_unit);
  program.set("ivory_difmap_scale", map.scale);
  program.set("ivory_difmap_from_world", turn_about_y(-double(map.turn_rad)));
  return first_unit + 1;
}

AmbientSource ambient(const GpuDifMap& map) {
  return {"#include \"ambient/difmap.glsl\"\n",
          [&map](gl::Program& program, int first_unit) { return bind(map, program, first_unit); }};
}

}  // namespace ivory
