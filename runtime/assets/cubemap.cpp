#include "runtime/assets/cubemap.h"

#include <vector>

#include "grid/base/error.h"
#include "grid/cubemap/edges.h"
#include "grid/io/cubemap.h"

namespace ivory {

GpuLocalizedCube upload(const LocalizedCube& cube, const std::string& what) {
  gl::require_context();
  const std::string fault = find_fault(cube);
  if (!fault.empty()) throw Error(what, fault, "bake it again");
  const CubeEdges edges = make_cube_edges(cube);
  std::vector<V4f> texels;
  texels.reserve(2 * cube.corners.size() + 2 * edges.steps());
  for (const TexelCorners& v : cube.corners) texels.emplace_back(v[0], v[1], v[2], v[3]);
  for (const Rgb& radiance : cube.radiance.texels) texels.emplace_back(radiance.x, radiance.y, radiance.z, 0.0F);
  for (std::size_t i = 0; i < edges.steps(); ++i) {
    texels.emplace_back(edges.q_x[i], edges.q_y[i], edges.q_z[i], edges.inverse_depth[i]);
    texels.emplace_back(edges.jump[i].x, edges.jump[i].y, edges.jump[i].z, 0.0F);
  }
  GpuLocalizedCube result;
  result.texels = gl::make_texel_buffer(what, texels);
  result.origin_m = cube.origin_m;
  result.anchor_m = cube.anchor_m;
  result.size = cube.radiance.size;
  result.steps = int(edges.steps());
  result.brightest = edges.brightest;
  return result;
}

GpuLocalizedCube load_localized_cube(const std::string& path) { return upload(read_localized_cube(path), path); }

int bind(const GpuLocalizedCube& cube, gl::Program& program, int first_unit) {
  program.set("ivory_cubemap.origin", cube.origin_m);
  program.set("ivory_cubemap.size", cube.size);
  program.set("ivory_cubemap.steps", cube.steps);
  program.set("ivory_cubemap.brightest", cube.brightest);
  program.set("ivory_cubemap_texels", first_unit);
  gl::bind(cube.texels.texture, first_unit);
  return first_unit + 1;
}

AmbientSource ambient(const GpuLocalizedCube& cube, CubeMethod method) {
  std::string shader;
  if (method != CubeMethod::polygon)
    shader = "#define IVORY_CUBEMAP_METHOD ivory_cube_" + std::string(name_of(method)) + "\n";
  return {shader + "#include \"ambient/cubemap.glsl\"\n",
          [&cube](gl::Program& program, int first_unit) { return bind(cube, program, first_unit); }};
}

}  // namespace ivory
