// The polygons of a localized cube map summed edge by edge: the irradiance of CubeMethod::polygon in a quarter of the
// time, and without branches, so that shaders and vector units may do it line by line alike.
#pragma once

#include <vector>

#include "grid/cubemap/localized.h"

namespace ivory {

// A walk over all edges between texels, each once. Step i is a vertex of the shell, q and inverse depth as in
// TexelCorners, and the radiance to the left less that to the right, seen from inside, of the edge from step i - 1.
struct CubeEdges {
  std::vector<float> q_x, q_y, q_z, inverse_depth;
  std::vector<Rgb> jump;
  Rgb brightest{0, 0, 0};

  std::size_t steps() const { return jump.size(); }  // 12 size^2 + 5
};

CubeEdges make_cube_edges(const LocalizedCube& cube);  // of any cube without find_fault()

// irradiance(cube, CubeMethod::polygon, p, n), n unit, with `edges` of that cube: equal but for rounding, and in a
// shell of constant radiance L exactly pi L, also from where most of the shell is a point in the distance.
Rgb polygon_irradiance(const LocalizedCube& cube, const CubeEdges& edges, const V3f& p, const V3f& n);

}  // namespace ivory
