// Which surface a lightmap's texels lie on: the scene's charts, as its file brings them. Nothing is unwrapped here.
#pragma once

#include <vector>

#include "tracer/core/scene.h"

namespace ivory {

// The point of the scene that a texel stands for: that of its centre, or, where the centre lies in no triangle but the
// texel's square touches one, the nearest one of that triangle but a twentieth of a texel.
struct ChartTexel {
  int instance = no_index;  // none: no chart comes here
  int triangle = 0;         // of the instance's mesh
  V2f barycentric{0, 0};
};

struct Charts {
  int width = 0;
  int height = 0;
  int uv_set = 1;
  std::vector<ChartTexel> texels;  // height x width, v = 0 first, as glTF has it on top
};

// Of all instances of the scene but spherical lights, whose coordinates `uv_set` (loaded by LoadParams::uv_sets) lie in
// 0 to 1. Throws Error, which names the scene and the meshes, where coordinates are missing or have no area, lie
// outside, or where two triangles have the same place: of several charts, or of a mesh that is placed twice.
// ParameterError ("size") for sizes below 1 or above 16384.
Charts make_charts(const Scene& scene, int uv_set, int width, int height);

struct ChartPoint {
  V3f p;              // local, metres
  V3f ng;             // unit geometric normal of the front side
  V3f ns;             // unit smooth normal, without normal maps, on the same side
  float reach_m = 0;  // triangle_reach_m()
  bool both = false;  // its material shows both sides
};
// `offset`: from the texel's centre, in texels. What lies beyond the texel's own triangle is moved onto it.
ChartPoint chart_point(const Scene& scene, const Charts& charts, std::size_t texel, const V2f& offset);

}  // namespace ivory
