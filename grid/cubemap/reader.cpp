#include "grid/cubemap/reader.h"

namespace ivory {

namespace {

template <typename T>
std::size_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

std::size_t bytes_of(const CubeEdges& edges) {
  return bytes_of(edges.q_x) + bytes_of(edges.q_y) + bytes_of(edges.q_z) + bytes_of(edges.inverse_depth) +
         bytes_of(edges.jump);
}

CubeMap convolve(const LocalizedCube& cube) {
  const CubeEdges edges = make_cube_edges(cube);
  CubeMap map;
  map.size = convolved_cube_size;
  map.texels.reserve(std::size_t(cube_faces) * convolved_cube_size * convolved_cube_size);
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < map.size; ++row) {
      for (int column = 0; column < map.size; ++column)
        map.texels.push_back(
            polygon_irradiance(cube, edges, cube.origin_m, cube_texel_direction(map.size, face, row, column)));
    }
  }
  return map;
}

}  // namespace

CubeReader make_cube_reader(const LocalizedCube& cube, CubeMethod method) {
  CubeReader reader{&cube, method, {}, {}, 0};
  if (method == CubeMethod::convolved) {
    reader.convolved = convolve(cube);
    reader.bytes = bytes_of(reader.convolved.texels);
    return reader;
  }
  if (method == CubeMethod::polygon) reader.edges = make_cube_edges(cube);
  reader.bytes = bytes_of(cube.radiance.texels) + bytes_of(cube.corners) + bytes_of(reader.edges);
  return reader;
}

Rgb irradiance(const CubeReader& reader, const V3f& p, const V3f& n) {
  if (reader.method == CubeMethod::convolved) return bilinear(reader.convolved, n);
  if (reader.method == CubeMethod::polygon) return polygon_irradiance(*reader.cube, reader.edges, p, n);
  return irradiance(*reader.cube, reader.method, p, n);
}

}  // namespace ivory
