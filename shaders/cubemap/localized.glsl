// Irradiance from a localized cube map: large texels of radiance, each with the inverse distances of its four corners,
// as the polygons that they are. Twin of grid/cubemap/localized.cpp and grid/cubemap/edges.cpp, where the formulas are
// derived.
//
// Inputs: IvoryLocalizedCube and its samplerBuffer of RGBA32F, both from ivory::bind(GpuLocalizedCube): with M = size
//   [0, 6 M^2)            inverse depth of a texel's corners, 1/m: (0,0), (1,0), (0,1), (1,1), right, then down
//   [6 M^2, 12 M^2)       its radiance, nits
//   [12 M^2, + 2 steps)   the walk over the edges: q and inverse depth of a vertex; jump of radiance from the
//                         vertex before
//
// Each function takes a world position (m) and a unit normal and returns E in lux: never negative and finite. p outside
// of the shell reads a point a thousandth inside.
//
// What a receiver costs, M = 4 (96 texels, 197 steps): polygon 2 fetches and some 140 operations a step; polygon_paper
// 2 fetches and 190 a texel; point 2 and 110.
#include "base/pi.glsl"
#include "env/cube_map.glsl"

struct IvoryLocalizedCube {
  vec3 origin;     // world, m
  int size;        // M
  int steps;       // 12 M^2 + 5
  vec3 brightest;  // nits, of each channel
};

float ivory_largest(vec3 a) {
  vec3 b = abs(a);
  return max(b.x, max(b.y, b.z));
}

// A coordinate in [-1, 1] as a texel's index and how far into it, 0 to 1.
float ivory_cube_texel_of(int size, float coordinate, out int index) {
  float x = 0.5 * (coordinate + 1.0) * float(size);
  index = clamp(int(x), 0, size - 1);
  return clamp(x - float(index), 0.0, 1.0);
}

// Inverse depth within a texel: linear over each of its two triangles.
float ivory_cube_depth_in(vec4 v, float right, float down) {
  return right > down ? v.x + right * (v.y - v.x) + down * (v.w - v.y)
                      : v.x + down * (v.z - v.x) + right * (v.w - v.z);
}

// `offset` = p - origin, brought inside the shell; not finite gives 0, and nothing is farther than 1e12 m.
vec3 ivory_inside_shell(IvoryLocalizedCube cube, samplerBuffer texels, vec3 offset) {
  const float outermost = 0.999;
  const float farthest_m = 1e12;
  float m = ivory_largest(offset);
  if (!(m > 0.0 && m <= 3.4e38) || any(isnan(offset))) return vec3(0.0);
  vec3 w = offset * (1.0 / m);
  int face, column, row;
  float s, t;
  ivory_cube_position(w, face, s, t);
  float right = ivory_cube_texel_of(cube.size, s, column);
  float down = ivory_cube_texel_of(cube.size, t, row);
  float v = ivory_cube_depth_in(texelFetch(texels, (face * cube.size + row) * cube.size + column), right, down);
  float reach = m * v > outermost ? outermost / v : m;
  return m > farthest_m || m * v > outermost ? w * min(reach, farthest_m) : offset;
}

// Unit direction from offset o to the shell's vertex q / v, in a frame whose axes are the rows of `axes`.
vec3 ivory_cube_see(mat3 axes, vec3 o, vec4 vertex) {
  vec3 r = vertex.xyz * axes - vertex.w * o;
  return r * inversesqrt(max(dot(r, r), 1e-30));
}

// An angle over its sine by its cosine, 0 to 1.
float ivory_angle_over_sine(float c) {
  float g = -0.0266371518;
  g = g * c + 0.135951281;
  g = g * c - 0.323932022;
  g = g * c + 0.509054601;
  g = g * c - 0.648626983;
  g = g * c + 0.783297896;
  g = g * c - 0.99990356;
  return g * c + 1.57079554;
}

// Angle between unit a and b times the z of the normal of the plane through both: an edge's term of Lambert's sum about
// z.
float ivory_edge_term(vec3 a, vec3 b) {
  vec3 n = cross(a, b);
  float cosine = dot(a, b);
  float g = ivory_angle_over_sine(abs(cosine));
  return (cosine >= 0.0 ? g : ivory_pi * inversesqrt(max(dot(n, n), 1e-30)) - g) * n.z;
}

// What an edge from unit a to unit b, z the normal, contributes to 2 E per jump; a.w and b.w are how far they lie over
// the anchor's direction, as sines.
float ivory_edge_weight(vec4 a, vec4 b, bool d_above) {
  bool a_above = a.z >= 0.0;
  bool b_above = b.z >= 0.0;
  float rising = a_above ? -1.0 : 1.0;
  // Where it crosses the horizon: along (m, det), times `rising`.
  float m = a.x * b.z - b.x * a.z;
  float det = a.y * b.z - b.y * a.z;
  vec3 crossing = vec3(m, det, 0.0) * (rising * inversesqrt(max(m * m + det * det, 1e-30)));
  float term = ivory_edge_term(a_above ? a.xyz : crossing, b_above ? b.xyz : crossing);
  bool over_horizon = a_above != b_above;
  bool over_meridian = (a.y >= 0.0) != (b.y >= 0.0);
  float from = a.y >= 0.0 ? 1.0 : -1.0;
  float agreed = over_horizon ? rising * from : -rising * from;
  float det_sign = over_horizon && over_meridian ? (det >= 0.0 ? 1.0 : -1.0) : agreed;
  float angle = ivory_angle_over_sine(abs(crossing.x)) * abs(crossing.y);  // as if crossing.x >= 0
  float horizon = over_horizon ? det_sign * (crossing.x >= 0.0 ? angle : ivory_pi - angle) : 0.0;
  float side = d_above ? -from : from;
  float beyond = side * (a.y * b.w - b.y * a.w);
  bool crosses_arc = over_meridian && side * det_sign < 0.0 && beyond > 0.0;
  return term + horizon + (crosses_arc ? 2.0 * ivory_pi * side : 0.0);
}

// CubeMethod::polygon for an offset within the shell, all edges once; offset 0 is CubeMethod::convolved.
vec3 ivory_cube_polygon_inside(IvoryLocalizedCube cube, samplerBuffer texels, vec3 offset, vec3 n) {
  const float inner_part = 1.0 / 128.0;
  int size = cube.size;
  // The texel that the ray from the origin meets behind p, and a direction from p into its inner part.
  int face, column, row;
  float s, t;
  ivory_cube_position(offset, face, s, t);
  float right = ivory_cube_texel_of(size, s, column);
  float down = ivory_cube_texel_of(size, t, row);
  int texel = (face * size + row) * size + column;
  vec4 v = texelFetch(texels, texel);
  float share = ivory_largest(offset) * ivory_cube_depth_in(v, right, down);
  float inner = inner_part * clamp(1.0 - share, 1e-3, 1.0);
  float growth = ivory_largest(offset) * ivory_cube_depth_in(v, clamp(right, inner, 1.0 - inner),
                                                             clamp(down, inner, 1.0 - inner)) - share;
  if (growth > 0.5 * (1.0 - share)) inner *= 0.5 * (1.0 - share) / growth;
  right = clamp(right, inner, 1.0 - inner);
  down = clamp(down, inner, 1.0 - inner);
  vec3 forward_axis, right_axis, down_axis;
  ivory_cube_face_axes(face, forward_axis, right_axis, down_axis);
  vec3 d = forward_axis + right_axis * (2.0 * (float(column) + right) / float(size) - 1.0) +
           down_axis * (2.0 * (float(row) + down) / float(size) - 1.0) -
           offset * ivory_cube_depth_in(v, right, down);
  d = normalize(d / ivory_largest(d));

  float up = dot(n, d);
  vec3 x = n * up - d;
  float across = length(x);
  // Along the normal any meridian holds d.
  if (across > 1e-5)
    x /= across;
  else
    x = normalize(abs(n.x) > 0.5 ? vec3(n.y, -n.x, 0.0) : vec3(0.0, n.z, -n.y));
  mat3 axes = mat3(x, cross(n, x), n);
  vec3 o = offset * axes;

  bool d_above = up >= 0.0;
  int at = 12 * size * size;
  vec4 a = vec4(0.0);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < cube.steps; ++i) {  // the first has no edge before it, and no jump
    vec3 r = ivory_cube_see(axes, o, texelFetch(texels, at));
    vec4 b = vec4(r, r.x * up + r.z * across);
    sum += texelFetch(texels, at + 1).rgb * ivory_edge_weight(a, b, d_above);
    a = b;
    at += 2;
  }
  vec3 e = texelFetch(texels, 6 * size * size + texel).rgb * ivory_pi + sum * 0.5;
  return clamp(e, vec3(0.0), ivory_pi * cube.brightest);
}

vec3 ivory_cube_polygon(IvoryLocalizedCube cube, samplerBuffer texels, vec3 p, vec3 n) {
  return ivory_cube_polygon_inside(cube, texels, ivory_inside_shell(cube, texels, p - cube.origin), n);
}

vec3 ivory_cube_convolved(IvoryLocalizedCube cube, samplerBuffer texels, vec3 p, vec3 n) {
  return ivory_cube_polygon_inside(cube, texels, vec3(0.0), n);
}

// Polygons without a cut at the horizon: a texel whose sum is negative counts as 0.
vec3 ivory_cube_polygon_paper(IvoryLocalizedCube cube, samplerBuffer texels, vec3 p, vec3 n) {
  int size = cube.size;
  vec3 offset = ivory_inside_shell(cube, texels, p - cube.origin);
  vec3 x = normalize(abs(n.x) > 0.5 ? vec3(n.y, -n.x, 0.0) : vec3(0.0, n.z, -n.y));
  mat3 axes = mat3(x, cross(n, x), n);
  vec3 o = offset * axes;
  vec3 sum = vec3(0.0);
  int texel = 0;
  for (int row = 0; row < 6 * size; ++row) {  // of all faces
    vec3 forward_axis, right_axis, down_axis;
    int face = row / size;
    ivory_cube_face_axes(face, forward_axis, right_axis, down_axis);
    vec3 top = forward_axis + down_axis * (float(2 * (row - face * size) - size) / float(size));
    vec3 bottom = forward_axis + down_axis * (float(2 * (row - face * size) + 2 - size) / float(size));
    vec4 v = texelFetch(texels, texel);
    vec3 r00 = ivory_cube_see(axes, o, vec4(top - right_axis, v.x));
    vec3 r01 = ivory_cube_see(axes, o, vec4(bottom - right_axis, v.z));
    float left = ivory_edge_term(r01, r00);
    for (int column = 1; column <= size; ++column) {
      v = texelFetch(texels, texel);
      vec3 s1 = right_axis * (float(2 * column - size) / float(size));
      vec3 r10 = ivory_cube_see(axes, o, vec4(top + s1, v.y));
      vec3 r11 = ivory_cube_see(axes, o, vec4(bottom + s1, v.w));
      float right = ivory_edge_term(r10, r11);
      float factor = 0.5 * (ivory_edge_term(r00, r10) + right + ivory_edge_term(r11, r01) + left);
      sum += texelFetch(texels, 6 * size * size + texel).rgb * max(factor, 0.0);
      r00 = r10;
      r01 = r11;
      left = -right;
      ++texel;
    }
  }
  return sum;
}

// Each texel a small patch at its centre.
vec3 ivory_cube_point(IvoryLocalizedCube cube, samplerBuffer texels, vec3 p, vec3 n) {
  int size = cube.size;
  float texel_size = 2.0 / float(size);
  vec3 offset = ivory_inside_shell(cube, texels, p - cube.origin);
  vec3 sum = vec3(0.0);
  int texel = 0;
  for (int row = 0; row < 6 * size; ++row) {
    vec3 forward_axis, right_axis, down_axis;
    int face = row / size;
    ivory_cube_face_axes(face, forward_axis, right_axis, down_axis);
    vec3 q = forward_axis - right_axis + down_axis * (float(2 * (row - face * size) - size) / float(size));
    vec3 across = right_axis * texel_size;
    vec3 along = down_axis * texel_size;
    for (int column = 0; column < size; ++column) {
      vec4 v = texelFetch(texels, texel);
      vec3 r00 = q - offset * v.x;
      vec3 r10 = q + across - offset * v.y;
      vec3 r01 = q + along - offset * v.z;
      vec3 r11 = q + across + along - offset * v.w;
      float m = max(max(ivory_largest(r00), ivory_largest(r10)), max(ivory_largest(r01), ivory_largest(r11)));
      float scale = 1.0 / max(m, 1e-30);
      vec3 r = (r00 + r10 + r01 + r11) * (0.25 * scale);
      vec3 u = (r10 + r11 - r00 - r01) * (0.5 * scale);
      vec3 w = (r01 + r11 - r00 - r10) * (0.5 * scale);
      float height = dot(r, n);
      float facing = dot(r, cross(u, w));
      // Nearer than a ten-thousandth of its size it counts as that far away.
      float r2 = max(max(dot(r, r), 1e-8 * (dot(u, u) + dot(w, w))), 1e-15);
      float factor = max(height, 0.0) * max(facing, 0.0) / (r2 * r2);
      sum += texelFetch(texels, 6 * size * size + texel).rgb * factor;
      q += across;
      ++texel;
    }
  }
  return sum;
}
