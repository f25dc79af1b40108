#include "grid/localized_cube.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "grid/error.h"

// From a receiver at P relative to the origin, the shell's vertex q / v lies in direction
//
//   r = q / v - P  ~  q - v P,
//
// which needs no division and, for the sky, v = 0, is q: near surfaces and sky are one case. Scaling r
// by a positive number changes none of what follows.

namespace ivory {

namespace {

constexpr std::array<std::pair<std::string_view, CubeMethod>, 4> method_names{
    {{"convolved", CubeMethod::convolved},
     {"point", CubeMethod::point},
     {"polygon", CubeMethod::polygon},
     {"polygon_paper", CubeMethod::polygon_paper}}};

}  // namespace

std::string_view name(CubeMethod method) {
  for (const auto& [text, value] : method_names) {
    if (value == method) return text;
  }
  return "";
}

CubeMethod cube_method_from_name(std::string_view text) {
  for (const auto& [known, value] : method_names) {
    if (known == text) return value;
  }
  throw UsageError("unknown way to read a cube map: '" + std::string(text) + "'");
}

namespace {

struct Receiver {
  V3f p;  // relative to the origin
  V3f n;
};

float largest(const V3f& a) { return std::max(std::abs(a.x), std::max(std::abs(a.y), std::abs(a.z))); }

// Coordinates up to 1, or none: products of three such vectors do not overflow.
V3f scaled(const V3f& r) {
  const float m = largest(r);
  return m > 1e-30F ? r * (1.0F / m) : V3f(0, 0, 0);
}

// Where a texel's corners lie on the cube. By the edges' own coordinates, not by adding steps, so that
// neighbours agree to the last bit.
struct TexelFrame {
  const CubeFaceAxes& axes;
  float s[2];
  float t[2];

  TexelFrame(const CubeFaceAxes& face, int size, int row, int column) : axes(face) {
    for (int k = 0; k < 2; ++k) {
      s[k] = float(cube_edge(size, column + k));
      t[k] = float(cube_edge(size, row + k));
    }
  }
  V3f corner(int right, int down) const { return axes.forward + axes.right * s[right] + axes.down * t[down]; }
};

// Angle between a and b times the cosine between n and the normal of the plane through both: one term of
// Lambert's sum (eq. 1 of the paper, without its 1/2). atan2 keeps its accuracy near 0 and pi, where acos of a
// rounded dot product loses half the digits; an edge without length, or through the receiver, has no
// normal and counts 0.
float edge_term(const V3f& a, const V3f& b, const V3f& n) {
  const V3f c = a.cross(b);
  const float sine = std::sqrt(c.dot(c));
  if (!(sine > 0)) return 0;
  return std::atan2(sine, a.dot(b)) * (c.dot(n) / sine);
}

// The edge's part above the horizon; ha and hb are the heights n.a, n.b.
float edge_term_above(const V3f& a, float ha, const V3f& b, float hb, const V3f& n) {
  if (ha >= 0 && hb >= 0) return edge_term(a, b, n);
  if (ha < 0 && hb < 0) return 0;
  const V3f x = a + (b - a) * (ha / (ha - hb));
  return ha >= 0 ? edge_term(a, x, n) : edge_term(x, b, n);
}

// A triangle cut at the horizon gains an edge within it, from where its outline sinks to where it rises again.
// Its term is the angle between the two, signed about n.
float horizon_term(const V3f& a, float ha, const V3f& b, float hb, const V3f& c, float hc, const V3f& n) {
  V3f sinks(0, 0, 0);
  V3f rises(0, 0, 0);
  const auto meet = [&](const V3f& from, float h_from, const V3f& to, float h_to) {
    if ((h_from >= 0) == (h_to >= 0)) return;
    const V3f x = from + (to - from) * (h_from / (h_from - h_to));
    (h_from >= 0 ? sinks : rises) = x;
  };
  meet(a, ha, b, hb);
  meet(b, hb, c, hc);
  meet(c, hc, a, ha);
  return std::atan2(sinks.cross(rises).dot(n), sinks.dot(rises));
}

// Twice the form factor of one texel, times pi: of the triangles 00-10-11 and 00-11-01, counter-clockwise from
// inside. Both carry the same radiance, so that their common edge, run through once in each direction,
// cancels and is left out. A triangle seen from behind, where the shell folds over itself as seen from p,
// counts negative: it stands between p and the part of the shell that it covers, and takes that part's light
// away. This is what makes all texels together cover each direction exactly once.
float polygon_texel(const TexelFrame& frame, const TexelCorners& v, const Receiver& receiver, bool cut) {
  const V3f r00 = scaled(frame.corner(0, 0) - receiver.p * v[0]);
  const V3f r10 = scaled(frame.corner(1, 0) - receiver.p * v[1]);
  const V3f r01 = scaled(frame.corner(0, 1) - receiver.p * v[2]);
  const V3f r11 = scaled(frame.corner(1, 1) - receiver.p * v[3]);
  const V3f& n = receiver.n;
  if (!cut) return edge_term(r00, r10, n) + edge_term(r10, r11, n) + edge_term(r11, r01, n) + edge_term(r01, r00, n);

  const float h00 = r00.dot(n);
  const float h10 = r10.dot(n);
  const float h01 = r01.dot(n);
  const float h11 = r11.dot(n);
  if (h00 < 0 && h10 < 0 && h01 < 0 && h11 < 0) return 0;
  float sum = edge_term_above(r00, h00, r10, h10, n) + edge_term_above(r10, h10, r11, h11, n) +
              edge_term_above(r11, h11, r01, h01, n) + edge_term_above(r01, h01, r00, h00, n);
  if (h00 >= 0 && h10 >= 0 && h01 >= 0 && h11 >= 0) return sum;
  sum += horizon_term(r00, h00, r10, h10, r11, h11, n);
  sum += horizon_term(r00, h00, r11, h11, r01, h01, n);
  return sum;
}

// With the texel's centre in direction r and its sides r_u, r_v, the patch covers the solid angle
// det(r, r_u, r_v) / |r|^3 as seen from p: the area times cosine over distance squared of the point-to-point form
// factor, written without dividing by v. Nearer than a ten-thousandth of its size the patch counts as
// that far away, which keeps the answer finite but not small.
float point_texel(const TexelFrame& frame, const TexelCorners& v, const Receiver& receiver) {
  const V3f r00 = frame.corner(0, 0) - receiver.p * v[0];
  const V3f r10 = frame.corner(1, 0) - receiver.p * v[1];
  const V3f r01 = frame.corner(0, 1) - receiver.p * v[2];
  const V3f r11 = frame.corner(1, 1) - receiver.p * v[3];
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

Rgb irradiance(const LocalizedCube& cube, CubeMethod method, const V3f& p, const V3f& n) {
  const V3f offset = p - cube.origin_m;
  const Receiver receiver{method == CubeMethod::convolved ? V3f(0, 0, 0) : inside_shell(cube, offset), n};
  const int size = cube.radiance.size;
  Rgb sum(0, 0, 0);
  Rgb brightest(0, 0, 0);
  std::size_t i = 0;
  for (int face = 0; face < cube_faces; ++face) {
    const CubeFaceAxes& axes = cube_face_axes(face);
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column, ++i) {
        const TexelFrame frame(axes, size, row, column);
        const TexelCorners& v = cube.corners[i];
        float factor = 0;
        switch (method) {
          case CubeMethod::convolved:
          case CubeMethod::polygon:
            factor = 0.5F * polygon_texel(frame, v, receiver, /*cut=*/true);
            break;
          case CubeMethod::polygon_paper:
            factor = std::max(0.0F, 0.5F * polygon_texel(frame, v, receiver, /*cut=*/false));
            break;
          case CubeMethod::point:
            factor = point_texel(frame, v, receiver);
            break;
        }
        const Rgb& radiance = cube.radiance.texels[i];
        sum += radiance * factor;
        for (int c = 0; c < 3; ++c) brightest[c] = std::max(brightest[c], radiance[c]);
      }
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
