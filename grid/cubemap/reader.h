// A localized cube map made ready for one way of reading it: what that way reads, and nothing else.
#pragma once

#include "grid/cubemap/edges.h"

namespace ivory {

// Texels along an edge of a face of the convolved map. Bilinear reading is off by about an eighth of a texel's width
// squared times E's curvature, a texel being 1/8 rad in the middle of a face: two thousandths of E, five beside the
// cube's corners.
inline constexpr int convolved_cube_size = 16;

struct CubeReader {
  const LocalizedCube* cube = nullptr;  // not owned
  CubeMethod method = CubeMethod::polygon;
  CubeEdges edges;        // for polygon
  CubeMap convolved;      // for convolved: E in lux at the reference point, by normal
  std::size_t bytes = 0;  // memory that irradiance() reads from: convolved: the convolved map alone; point,
                          // polygon_paper: radiance and distances; polygon: these and the edges
};

// `cube` must outlive the reader.
CubeReader make_cube_reader(const LocalizedCube& cube, CubeMethod method);

// E in lux at p (world, m) for unit normal n, as irradiance(cube, method, p, n) defines it but for what polygons summed
// by edges round otherwise and for the convolved map's interpolation.
Rgb irradiance(const CubeReader& reader, const V3f& p, const V3f& n);

}  // namespace ivory
