// Radiance (nits) of a lat-long environment map towards the unit direction w. OpenEXR's layout: row 0 looks towards +Y,
// u = 1/2 + atan(-x, z) / (2 pi). Twin of grid/env/latlong_map.cpp. The map's texture has one level, repeats across
// and is clamped at the poles; with the nearest filter it is what the tracer reads.
#include "base/pi.glsl"

vec3 ivory_sky(sampler2D sky, vec3 w) {
  float u = 0.5 + atan(-w.x, w.z) / (2.0 * ivory_pi);
  float v = atan(length(w.xz), w.y) / ivory_pi;  // acos has no digits left near the poles
  return textureLod(sky, vec2(u, v), 0.0).rgb;
}
