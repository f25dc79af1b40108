// The vertices that a look-up in a grid reads, and their weights. Twin of make_footprint() in
// grid/field/irradiance_grid.cpp.
//
// Inputs, passed as parameters:
//   IvoryGrid g              the numbers, of one level: field/grid.glsl
//   usampler3D guard         where vertices of several levels stand: field/levels.glsl
//   vec3 index               the point's index coordinates in that level: vertex (i, j, k) has (i, j, k)
//   int interpolation        ivory_trilinear or ivory_tricubic
// Weights add up to one; beyond the border the outermost vertices are repeated.
#include "field/levels.glsl"

// The vertices that one axis contributes, from `first` on, and their weights: two or four.
void ivory_axis_footprint(float x, int size, int interpolation, out int first, out vec4 weight) {
  float clamped = clamp(x, 0.0, float(size - 1));
  int base = min(int(clamped), size - 2);
  float t = clamped - float(base);
  float s = 1.0 - t;
  if (interpolation == ivory_trilinear) {
    first = base;
    weight = vec4(s, t, 0.0, 0.0);
  } else {
    first = base - 1;
    weight = vec4(s * s * s, 4.0 - 6.0 * t * t + 3.0 * t * t * t, 4.0 - 6.0 * s * s + 3.0 * s * s * s, t * t * t) / 6.0;
  }
}

// The vertices that a look-up reads: entry e is vertex first + (e % width, e / width % width, e / width^2), beyond the
// border the outermost one instead.
struct IvoryFootprint {
  ivec3 first;
  vec4 x;  // weights along the axes
  vec4 y;
  vec4 z;
  bool wide;  // 64 entries, else 8
};
IvoryFootprint ivory_make_footprint(IvoryGrid g, vec3 index, int interpolation) {
  IvoryFootprint footprint;
  ivory_axis_footprint(index.x, g.size.x, interpolation, footprint.first.x, footprint.x);
  ivory_axis_footprint(index.y, g.size.y, interpolation, footprint.first.y, footprint.y);
  ivory_axis_footprint(index.z, g.size.z, interpolation, footprint.first.z, footprint.z);
  footprint.wide = interpolation == ivory_tricubic;
  return footprint;
}
int ivory_footprint_count(IvoryFootprint footprint) { return footprint.wide ? 64 : 8; }

void ivory_footprint_entry(IvoryGrid g, IvoryFootprint footprint, int e, out ivec3 vertex, out float weight) {
  ivec3 at = footprint.wide ? ivec3(e & 3, (e >> 2) & 3, e >> 4) : ivec3(e & 1, (e >> 1) & 1, e >> 2);
  vertex = clamp(footprint.first + at, ivec3(0), g.size - 1);
  weight = footprint.z[at.z] * footprint.y[at.y] * footprint.x[at.x];
}

// What the footprint's weights are to be multiplied by, so that those of stored vertices add up to one.
float ivory_stored_factor(IvoryGrid g, usampler3D guard, IvoryFootprint footprint, int count) {
  float stored = 0.0;
  bool whole = true;
  for (int e = 0; e < count; ++e) {
    ivec3 vertex;
    float weight;
    ivory_footprint_entry(g, footprint, e, vertex, weight);
    bool is_there = ivory_grid_texel(g, guard, vertex).x >= 0;
    stored += is_there ? weight : 0.0;
    whole = whole && is_there;
  }
  return whole || stored <= 0.0 ? 1.0 : 1.0 / stored;
}
