// Radiance of a lat-long environment map as OpenEXR lays it out: row 0 looks towards +Y, u = 1/2 + atan(-x, z) / (2 pi);
// twin of grid/env/latlong_map.cpp. `w` is a unit direction; the map repeats across, ends at the poles and has one level; with
// the nearest filter it is what the tracer reads.
vec3 ivory_sky(sampler2D sky, vec3 w) {
  const float pi = 3.14159265358979;
  float u = 0.5 + atan(-w.x, w.z) / (2.0 * pi);
  float v = atan(length(w.xz), w.y) / pi;  // acos has no digits left near the poles
  return textureLod(sky, vec2(u, v), 0.0).rgb;
}
