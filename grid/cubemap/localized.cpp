#include "grid/cubemap/localized.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "grid/base/anchor.h"
#include "grid/base/fast_angle.h"

// From a receiver at P relative to the origin, the shell's vertex q / v lies in direction
//
//   r = q / v - P  ~  q - v P,
//
// which needs no division and, for the sky, v = 0, is q: near surfaces and sky are one case. Scaling r by a positive
// number changes none of what follows.

namespace ivory {

namespace {

float largest(const V3f& a) { return std::max(std::abs(a.x), std::max(std::abs(a.y), std::abs(a.z))); }

// The receiver in a face's own axes, right, down and forward: there q is (s, t, 1).
struct Receiver {
  V3f p;  // relative to the origin
  V3f n;
};

V3f to_face(const CubeFaceAxes& axes, const V3f& a) {
  return {a.dot(axes.right), a.dot(axes.down), a.dot(axes.forward)};
}

// A corner of a texel as the receiver sees it: direction, of any length, and height above the horizon.
struct Corner {
  V3f r;
  float h;
};

Corner see_corner(float s, float t, float v, const Receiver& receiver) {
  V3f r(s - v * receiver.p.x, t - v * receiver.p.y, 1 - v * receiver.p.z);
  // All of about one length: where an edge crosses the horizon is told from both its ends, and the far one must not
  // drown in the rounding of the near one.
  const float m = largest(r);
  if (m > 1e-30F) r *= 1.0F / m;
  return {r, r.dot(receiver.n)};
}

// Angle between a and b times the cosine between n and the normal of the plane through both: one term of Lambert's sum
// (eq. 1 of the paper, without its 1/2). atan2 keeps its accuracy near 0 and pi, where acos of a rounded dot product
// loses half the digits; an edge without length, or through the receiver, has no normal and counts 0.
float edge_term(const V3f& a, const V3f& b, const V3f& n) {
  const V3f c = a.cross(b);
  const float sine = std::sqrt(c.dot(c));
  if (!(sine > 0)) return 0;
  return fast_angle(sine, a.dot(b)) * (c.dot(n) / sine);
}

// Where the edge from a to b meets the horizon; the two lie on either side.
V3f horizon_crossing(const Corner& a, const Corner& b) { return a.r + (b.r - a.r) * (a.h / (a.h - b.h)); }

// The part of the edge that lies above the horizon, or all of it.
float edge_term(const Corner& a, const Corner& b, const V3f& n, bool cut) {
  if (!cut || (a.h >= 0 && b.h >= 0)) return edge_term(a.r, b.r, n);
  if (a.h < 0 && b.h < 0) return 0;
  const V3f x = horizon_crossing(a, b);
  return a.h >= 0 ? edge_term(a.r, x, n) : edge_term(x, b.r, n);
}

// A triangle cut at the horizon gains an edge within it, from where its outline sinks to where it rises again. Its term
// is the angle between the two, signed about n.
float horizon_term(const Corner& a, const Corner& b, const Corner& c, const V3f& n) {
  V3f sinks(0, 0, 0);
  V3f rises(0, 0, 0);
  const auto follow = [&](const Corner& from, const Corner& to) {
    if ((from.h >= 0) != (to.h >= 0)) (from.h >= 0 ? sinks : rises) = horizon_crossing(from, to);
  };
  follow(a, b);
  follow(b, c);
  follow(c, a);
  return fast_angle(sinks.cross(rises).dot(n), sinks.dot(rises));
}

// Calls add(texel, form factor times pi) for all texels of a face.
//
// A texel is the triangles 00-10-11 and 00-11-01, counter-clockwise from inside. Both carry the same radiance, so that
// their common edge, run through once in each direction, cancels and is left out; and a texel's right edge is the left
// one of the next, the other way round. A triangle seen from behind, where the shell folds over itself as seen from p,
// counts negative: it stands between p and the part of the shell that it covers, and takes that part's light away. This
// is what makes all texels together cover each direction exactly once.
template <typename Add>
void add_polygons(const LocalizedCube& cube, int face, const Receiver& receiver, bool cut, const Add& add) {
  const int size = cube.radiance.size;
  const V3f& n = receiver.n;
  for (int row = 0; row < size; ++row) {
    const float t0 = float(cube_edge(size, row));
    const float t1 = float(cube_edge(size, row + 1));
    std::size_t texel = cube_index(size, face, row, 0);
    Corner r00 = see_corner(-1, t0, cube.corners[texel][0], receiver);
    Corner r01 = see_corner(-1, t1, cube.corners[texel][2], receiver);
    float left = edge_term(r01, r00, n, cut);
    for (int column = 0; column < size; ++column, ++texel) {
      const float s1 = float(cube_edge(size, column + 1));
      const Corner r10 = see_corner(s1, t0, cube.corners[texel][1], receiver);
      const Corner r11 = see_corner(s1, t1, cube.corners[texel][3], receiver);
      const float right = edge_term(r10, r11, n, cut);
      float sum = edge_term(r00, r10, n, cut) + right + edge_term(r11, r01, n, cut) + left;
      const bool above = r00.h >= 0;
      if (cut && (above != (r10.h >= 0) || above != (r01.h >= 0) || above != (r11.h >= 0)))
        sum += horizon_term(r00, r10, r11, n) + horizon_term(r00, r11, r01, n);
      add(texel, 0.5F * sum);
      r00 = r10;
      r01 = r11;
      left = -right;
    }
  }
}

// With the texel's centre in direction r and its sides r_u, r_v, the patch covers the solid angle det(r, r_u, r_v) /
// |r|^3 as seen from p: the area times cosine over distance squared of the point-to-point form factor, written without
// dividing by v. Nearer than a ten-thousandth of its size the patch counts as that far away, which keeps the answer
// finite but not small.
float point_texel(float s, float t, float step, const TexelCorners& v, const Receiver& receiver) {
  const auto see = [&](float right, float down, float inverse_depth) {
    return V3f(s + right, t + down, 1) - receiver.p * inverse_depth;
  };
  const V3f r00 = see(0, 0, v[0]);
  const V3f r10 = see(step, 0, v[1]);
  const V3f r01 = see(0, step, v[2]);
  const V3f r11 = see(step, step, v[3]);
  const float m = std::max(std::max(largest(r00), largest(r10)), std::max(largest(r01), largest(r11)));
  if (!(m > 1e-30F)) return 0;
  const float scale = 1.0F / m;
  const V3f r = (r00 + r10 + r01 + r11) * (0.25F * scale);
  const V3f u = (r10 + r11 - r00 - r01) * (0.5F * scale);
  const V3f w = (r01 + r11 - r00 - r10) * (0.5F * scale);
  const float height = r.dot(receiver.n);
  const float facing = r.dot(u.cross(w));
  if (!(height > 0) || !(facing > 0)) return 0;
  const float r2 = std::max(r.dot(r), 1e-8F * (u.dot(u) + w.dot(w)));
  return height / std::sqrt(r2) * (facing / (r2 * std::sqrt(r2)));
}

template <typename Add>
void add_points(const LocalizedCube& cube, int face, const Receiver& receiver, const Add& add) {
  const int size = cube.radiance.size;
  const float step = 2.0F / float(size);
  std::size_t texel = cube_index(size, face, 0, 0);
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column, ++texel)
      add(texel, point_texel(float(cube_edge(size, column)), float(cube_edge(size, row)), step, cube.corners[texel],
                             receiver));
  }
}

// The texel's share of a coordinate in [-1, 1]: its index and how far into it.
std::pair<int, float> texel_of(int size, float coordinate) {
  const float x = 0.5F * (coordinate + 1) * float(size);
  const int i = std::clamp(int(x), 0, size - 1);
  return {i, std::clamp(x - float(i), 0.0F, 1.0F)};
}

// Inverse depth of the shell in direction w: linear over the triangle that it runs through.
float inverse_depth_towards(const LocalizedCube& cube, const V3f& w) {
  const CubePosition at = cube_position(w);
  const auto [column, right] = texel_of(cube.radiance.size, at.s);
  const auto [row, down] = texel_of(cube.radiance.size, at.t);
  const TexelCorners& v = cube.corners[cube_index(cube.radiance.size, at.face, row, column)];
  if (right > down) return v[0] + right * (v[1] - v[0]) + down * (v[3] - v[1]);
  return v[0] + down * (v[2] - v[0]) + right * (v[3] - v[2]);
}

}  // namespace

V3f inside_shell(const LocalizedCube& cube, const V3f& offset) {
  constexpr float outermost = 0.999F;
  constexpr float farthest_m = 1e30F;  // times the largest inverse depth is still a float
  const float m = largest(offset);
  if (!(m > 0 && m <= std::numeric_limits<float>::max())) return V3f(0, 0, 0);
  const V3f w = offset * (1.0F / m);
  if (!(w.dot(w) <= 4)) return V3f(0, 0, 0);  // NaN
  const float v = inverse_depth_towards(cube, w);
  if (m * v > outermost) return w * (outermost / v);
  return m > farthest_m ? w * farthest_m : offset;
}

void set_anchor(LocalizedCube& cube, const V3d& anchor_m) {
  cube.origin_m = to_local(to_world(cube.origin_m, cube.anchor_m), anchor_m);
  cube.anchor_m = anchor_m;
}

Rgb irradiance(const LocalizedCube& cube, CubeMethod method, const V3f& p, const V3f& n) {
  const V3f offset = method == CubeMethod::convolved ? V3f(0, 0, 0) : inside_shell(cube, p - cube.origin_m);
  Rgb sum(0, 0, 0);
  Rgb brightest(0, 0, 0);
  const auto add = [&](std::size_t texel, float factor) {
    const Rgb& radiance = cube.radiance.texels[texel];
    sum += radiance * factor;
    for (int c = 0; c < 3; ++c) brightest[c] = std::max(brightest[c], radiance[c]);
  };
  const auto add_positive = [&](std::size_t texel, float factor) { add(texel, std::max(factor, 0.0F)); };
  for (int face = 0; face < cube_faces; ++face) {
    const CubeFaceAxes& axes = cube_face_axes(face);
    const Receiver receiver{to_face(axes, offset), to_face(axes, n)};
    switch (method) {
      case CubeMethod::convolved:
      case CubeMethod::polygon:
        add_polygons(cube, face, receiver, /*cut=*/true, add);
        break;
      case CubeMethod::polygon_paper:
        add_polygons(cube, face, receiver, /*cut=*/false, add_positive);
        break;
      case CubeMethod::point:
        add_points(cube, face, receiver, add);
        break;
    }
  }
  const bool bounded = method == CubeMethod::polygon || method == CubeMethod::convolved;
  for (int c = 0; c < 3; ++c) {
    // Where the shell folds, the weights of texels are of either sign, and only their sum is known.
    const float most = bounded ? pi * brightest[c] : std::numeric_limits<float>::max();
    sum[c] = std::clamp(sum[c], 0.0F, most);
  }
  return sum;
}

std::vector<std::uint32_t> corner_vertices(int size) {
  // Corners by their whole-numbered place on a cube of side 2 size.
  std::map<std::array<int, 3>, std::uint32_t> vertex_at;
  std::vector<std::uint32_t> vertices;
  vertices.reserve(std::size_t(cube_faces) * std::size_t(size) * std::size_t(size) * 4);
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        for (int k = 0; k < 4; ++k) {
          const V3d q = cube_point(face, 2.0 * (column + k % 2) - size, 2.0 * (row + k / 2) - size);
          std::array<int, 3> place{};
          for (int c = 0; c < 3; ++c)
            place[c] = int(std::lround(q[c])) * (cube_face_axes(face).forward[c] != 0 ? size : 1);
          vertices.push_back(vertex_at.try_emplace(place, std::uint32_t(vertex_at.size())).first->second);
        }
      }
    }
  }
  return vertices;
}

std::string find_fault(const LocalizedCube& cube) {
  const int size = cube.radiance.size;
  const std::size_t texels = std::size_t(cube_faces) * std::size_t(size) * std::size_t(size);
  if (size < 1 || cube.radiance.texels.size() != texels || cube.corners.size() != texels) return "the size is wrong";
  for (int c = 0; c < 3; ++c) {
    if (!std::isfinite(cube.origin_m[c])) return "the position is not finite";
  }
  for (const Rgb& radiance : cube.radiance.texels) {
    for (int c = 0; c < 3; ++c) {
      if (!(radiance[c] >= 0 && radiance[c] <= greatest_radiance_nits)) return "a radiance is out of range";
    }
  }
  const std::vector<std::uint32_t> vertices = corner_vertices(size);
  std::vector<float> at_vertex(vertices.size(), -1.0F);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const float v = cube.corners[i / 4][i % 4];
    if (!(v >= 0 && v <= 2 / least_depth_m)) return "a distance is out of range";
    float& shared = at_vertex[vertices[i]];
    if (shared >= 0 && shared != v) return "neighbouring texels disagree about a corner";
    shared = v;
  }
  return "";
}

}  // namespace ivory
