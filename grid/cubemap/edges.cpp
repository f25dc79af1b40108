#include "grid/cubemap/edges.h"

#include <algorithm>
#include <array>
#include <cmath>

// Lambert's sum over the texels' outlines, cut at the horizon, is for radiances L_t
//
//   2 E = sum_t L_t ( sum of edge terms above the horizon + angle of the horizon within t ).
//
// An edge is run through by its two texels in opposite directions: its term counts once, times the jump of radiance
// across it. The horizon's part is the integral of L over the horizon's azimuth phi, by parts
//
//   2 pi L(u) + sum over the edges that cross the horizon of +- phi jump,
//
// u where phi jumps from pi to -pi. L(u) needs no search either: the ray from the reference point through the receiver
// meets the shell once, in a texel A behind the receiver. The frame is turned so that the direction d from the receiver
// to that point has azimuth pi, and L(u) = L(A) + the jumps across the arc from d to u. Radiances that are all the same
// leave 2 pi L.
//
// The decisions must agree with each other where rounding decides: those at u, of an edge between both sides of u and
// above and below it, are made by the sign of one determinant. Those at d are far from an edge, because d is turned
// into the inner part of A, by a fraction of a texel as the receiver sees it; so turned, the ray from the receiver
// meets no other texel either.

namespace ivory {

namespace {

struct Link {
  std::uint32_t to = 0;
  std::uint32_t edge = 0;
  float sign = 0;  // of the edge's jump when run through this way; 0 for an edge added
};

constexpr std::array<int, 4> outline{0, 1, 3, 2};  // corners counter-clockwise from inside

// 1/128 of a texel is a hundred times and more what rounding moves directions by.
constexpr float inner_part = 1.0F / 128;

float depth_in(const TexelCorners& v, float right, float down) {
  return right > down ? v[0] + right * (v[1] - v[0]) + down * (v[3] - v[1])
                      : v[0] + down * (v[2] - v[0]) + right * (v[3] - v[2]);
}

float largest(const V3f& a) { return std::max(std::abs(a.x), std::max(std::abs(a.y), std::abs(a.z))); }

// The texel that the ray from the reference point through `offset` meets, and a direction into it from there.
struct Anchor {
  std::size_t texel = 0;
  V3f d;
};

Anchor make_anchor(const LocalizedCube& cube, const V3f& offset) {
  const int size = cube.radiance.size;
  const CubePosition at = cube_position(offset);
  const float x = 0.5F * (at.s + 1) * float(size);
  const float y = 0.5F * (at.t + 1) * float(size);
  const int column = std::clamp(int(x), 0, size - 1);
  const int row = std::clamp(int(y), 0, size - 1);
  float right = std::clamp(x - float(column), 0.0F, 1.0F);
  float down = std::clamp(y - float(row), 0.0F, 1.0F);
  Anchor anchor;
  anchor.texel = cube_index(size, at.face, row, column);
  const TexelCorners& v = cube.corners[anchor.texel];
  // The nearer the shell, the less it takes to turn: 1 - share is the way left to it.
  const float share = largest(offset) * depth_in(v, right, down);
  float inner = inner_part * std::clamp(1 - share, 1e-3F, 1.0F);
  // Where the shell comes much nearer that way, from beside a hole, what is turned must still meet it behind the
  // receiver.
  const auto turned = [&](float a) { return std::clamp(a, inner, 1 - inner); };
  const float growth = largest(offset) * depth_in(v, turned(right), turned(down)) - share;
  if (growth > 0.5F * (1 - share)) inner *= 0.5F * (1 - share) / growth;
  right = turned(right);
  down = turned(down);
  const CubeFaceAxes& axes = cube_face_axes(at.face);
  const float s = 2 * (float(column) + right) / float(size) - 1;
  const float t = 2 * (float(row) + down) / float(size) - 1;
  anchor.d = axes.forward + axes.right * s + axes.down * t - offset * depth_in(v, right, down);
  anchor.d *= 1 / largest(anchor.d);
  anchor.d.normalize();
  return anchor;
}

// z is the normal; the anchor's direction is (-across, 0, up).
struct Frame {
  V3f x, y, z;
  float across = 0;
  float up = 0;
};

Frame make_frame(const V3f& n, const V3f& d) {
  Frame frame;
  frame.z = n;
  frame.up = n.dot(d);
  V3f x = n * frame.up - d;
  frame.across = x.length();
  if (frame.across > 1e-5F) {
    x /= frame.across;
  } else {
    // Along the normal: any meridian holds d.
    x = std::abs(n.x) > 0.5F ? V3f(n.y, -n.x, 0) : V3f(0, n.z, -n.y);
    x.normalize();
  }
  frame.x = x;
  frame.y = n.cross(x);
  return frame;
}

// An angle over its sine by its cosine, 0 to 1: a polynomial, the relative error 5e-7, interpolated at Chebyshev's
// points (numpy.polynomial.Chebyshev.interpolate, degree 7, domain [0, 1]).
inline float angle_over_sine(float c) {
  float g = -0.0266371518F;
  g = g * c + 0.135951281F;
  g = g * c - 0.323932022F;
  g = g * c + 0.509054601F;
  g = g * c - 0.648626983F;
  g = g * c + 0.783297896F;
  g = g * c - 0.99990356F;
  return g * c + 1.57079554F;
}

// What an edge from unit a to unit b, in the frame, contributes to 2 E per jump.
// a_over and b_over are how far they lie over d, as sines.
inline float edge_weight(const V3f& a, float a_over, const V3f& b, float b_over, bool d_above) {
  const bool a_above = a.z >= 0;
  const bool b_above = b.z >= 0;
  const float rising = a_above ? -1.0F : 1.0F;
  // Where it crosses the horizon: along (m, det), times `rising`.
  const float m = a.x * b.z - b.x * a.z;
  const float det = a.y * b.z - b.y * a.z;
  const float k = rising / std::sqrt(std::max(m * m + det * det, 1e-30F));
  const float hx = m * k;
  const float hy = det * k;
  // The part above, from s to e; below altogether both are the same point and the term is 0.
  const float sx = a_above ? a.x : hx;
  const float sy = a_above ? a.y : hy;
  const float sz = a_above ? a.z : 0.0F;
  const float ex = b_above ? b.x : hx;
  const float ey = b_above ? b.y : hy;
  const float ez = b_above ? b.z : 0.0F;
  const float cx = sy * ez - sz * ey;
  const float cy = sz * ex - sx * ez;
  const float cz = sx * ey - sy * ex;
  const float cosine = sx * ex + sy * ey + sz * ez;
  const float inverse_sine = 1 / std::sqrt(std::max(cx * cx + cy * cy + cz * cz, 1e-30F));
  const float g = angle_over_sine(std::abs(cosine));
  const float term = (cosine >= 0 ? g : pi * inverse_sine - g) * cz;

  // On which side of u it crosses horizon and meridian: for both by the determinant where it crosses both, else by what
  // its ends agree upon, also where the determinant is 0.
  const bool over_horizon = a_above != b_above;
  const bool over_meridian = (a.y >= 0) != (b.y >= 0);
  const float from = a.y >= 0 ? 1.0F : -1.0F;
  const float agreed = over_horizon ? rising * from : -rising * from;
  const float computed = det >= 0 ? 1.0F : -1.0F;
  const float det_sign = over_horizon && over_meridian ? computed : agreed;
  const float angle = angle_over_sine(std::abs(hx)) * std::abs(hy);  // as if hx >= 0
  const float horizon = over_horizon ? det_sign * (hx >= 0 ? angle : pi - angle) : 0.0F;

  // Does it cross the arc of the meridian between d and the horizon?
  const float side = d_above ? -from : from;
  const float beyond = side * (a.y * b_over - b.y * a_over);
  const bool crosses_arc = over_meridian && side * det_sign < 0 && beyond > 0;
  return term + horizon + (crosses_arc ? 2 * pi * side : 0.0F);
}

}  // namespace

CubeEdges make_cube_edges(const LocalizedCube& cube) {
  const int size = cube.radiance.size;
  const std::vector<std::uint32_t> vertex = corner_vertices(size);
  const std::size_t texels = cube.radiance.texels.size();
  struct Vertex {
    V3f q;
    float inverse_depth = 0;
    std::vector<Link> links;
  };
  std::vector<Vertex> vertices(texels + 2);
  std::vector<Rgb> jump;
  for (std::size_t texel = 0; texel < texels; ++texel) {
    const int face = int(texel) / (size * size);
    const int row = int(texel) / size % size;
    const int column = int(texel) % size;
    const Rgb& radiance = cube.radiance.texels[texel];
    for (int i = 0; i < 4; ++i) {
      const auto corner = [&](int k) { return vertex[4 * texel + std::size_t(outline[std::size_t(k % 4)])]; };
      const int k = outline[std::size_t(i)];
      const std::uint32_t from = corner(i);
      const std::uint32_t to = corner(i + 1);
      vertices[from].q = V3f(cube_point(face, cube_edge(size, column + k % 2), cube_edge(size, row + k / 2)));
      vertices[from].inverse_depth = cube.corners[texel][std::size_t(k)];
      std::vector<Link>& links = vertices[from].links;
      const auto known = std::find_if(links.begin(), links.end(), [&](const Link& link) { return link.to == to; });
      if (known != links.end()) {  // the neighbour ran through it the other way
        jump[known->edge] += radiance * known->sign;
        continue;
      }
      links.push_back({to, std::uint32_t(jump.size()), 1});
      vertices[to].links.push_back({from, std::uint32_t(jump.size()), -1});
      jump.push_back(radiance);
    }
  }

  // Four edges without jump make all vertices even: three edges meet at the corners of the cube.
  std::vector<std::uint32_t> odd;
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    if (vertices[i].links.size() % 2 != 0) odd.push_back(i);
  }
  for (std::size_t i = 0; i + 1 < odd.size(); i += 2) {
    vertices[odd[i]].links.push_back({odd[i + 1], std::uint32_t(jump.size()), 0});
    vertices[odd[i + 1]].links.push_back({odd[i], std::uint32_t(jump.size()), 0});
    jump.push_back(Rgb(0, 0, 0));
  }

  // Hierholzer's closed walk through all edges: go on while there is an unused edge, else step back and write down.
  CubeEdges result;
  std::vector<char> used(jump.size(), 0);
  struct Visit {
    std::uint32_t vertex;
    Rgb jump;  // of the edge that led here
  };
  std::vector<Visit> path{{0, Rgb(0, 0, 0)}};
  std::vector<Visit> walk;
  while (!path.empty()) {
    std::vector<Link>& links = vertices[path.back().vertex].links;
    while (!links.empty() && used[links.back().edge] != 0) links.pop_back();
    if (links.empty()) {
      walk.push_back(path.back());
      path.pop_back();
      continue;
    }
    const Link link = links.back();
    used[link.edge] = 1;
    path.push_back({link.to, jump[link.edge] * link.sign});
  }
  // Written backwards, so that each edge's jump stands with the vertex that it comes from.
  Rgb next(0, 0, 0);
  for (const Visit& visit : walk) {
    const Vertex& v = vertices[visit.vertex];
    result.q_x.push_back(v.q.x);
    result.q_y.push_back(v.q.y);
    result.q_z.push_back(v.q.z);
    result.inverse_depth.push_back(v.inverse_depth);
    result.jump.push_back(next * -1.0F);
    next = visit.jump;
  }
  for (const Rgb& radiance : cube.radiance.texels) {
    for (int c = 0; c < 3; ++c) result.brightest[c] = std::max(result.brightest[c], radiance[c]);
  }
  return result;
}

Rgb polygon_irradiance(const LocalizedCube& cube, const CubeEdges& edges, const V3f& p, const V3f& n) {
  constexpr std::size_t block = 256;
  constexpr float farthest_m = 1e12F;  // as far as products of four such numbers are floats
  V3f offset = inside_shell(cube, p - cube.origin_m);
  const float m = largest(offset);
  if (m > farthest_m) offset *= farthest_m / m;
  const Anchor anchor = make_anchor(cube, offset);
  const Frame frame = make_frame(n, anchor.d);
  const V3f o(offset.dot(frame.x), offset.dot(frame.y), offset.dot(frame.z));

  // In blocks, and what has no branches apart from the sums, whose order is fixed: the compiler makes vectors of it.
  std::array<float, block + 1> x;
  std::array<float, block + 1> y;
  std::array<float, block + 1> z;
  std::array<float, block + 1> over;
  std::array<float, block> weight;
  Rgb sum(0, 0, 0);
  for (std::size_t first = 0; first < edges.steps(); first += block) {
    const std::size_t count = std::min(block, edges.steps() - first);
    x[0] = x[block];
    y[0] = y[block];
    z[0] = z[block];
    over[0] = over[block];
    const float* q_x = edges.q_x.data() + first;
    const float* q_y = edges.q_y.data() + first;
    const float* q_z = edges.q_z.data() + first;
    const float* v = edges.inverse_depth.data() + first;
    for (std::size_t i = 0; i < count; ++i) {
      const float rx = q_x[i] * frame.x.x + q_y[i] * frame.x.y + q_z[i] * frame.x.z - v[i] * o.x;
      const float ry = q_x[i] * frame.y.x + q_y[i] * frame.y.y + q_z[i] * frame.y.z - v[i] * o.y;
      const float rz = q_x[i] * frame.z.x + q_y[i] * frame.z.y + q_z[i] * frame.z.z - v[i] * o.z;
      const float inverse = 1 / std::sqrt(std::max(rx * rx + ry * ry + rz * rz, 1e-30F));
      x[i + 1] = rx * inverse;
      y[i + 1] = ry * inverse;
      z[i + 1] = rz * inverse;
      over[i + 1] = x[i + 1] * frame.up + z[i + 1] * frame.across;
    }
    if (first == 0) {
      x[0] = x[1];
      y[0] = y[1];
      z[0] = z[1];
      over[0] = over[1];
    }
    for (std::size_t i = 0; i < count; ++i)
      weight[i] = edge_weight({x[i], y[i], z[i]}, over[i], {x[i + 1], y[i + 1], z[i + 1]}, over[i + 1], frame.up >= 0);
    for (std::size_t i = 0; i < count; ++i) sum += edges.jump[first + i] * weight[i];
  }
  const Rgb e = cube.radiance.texels[anchor.texel] * pi + sum * 0.5F;
  Rgb result;
  for (int c = 0; c < 3; ++c) result[c] = std::clamp(e[c], 0.0F, pi * edges.brightest[c]);
  return result;
}

}  // namespace ivory
