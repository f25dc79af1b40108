// What surfaces are made of. Private to those that make them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tracer/core/surface.h"

namespace ivory {

template <typename T>
T interpolate(const std::vector<T>& values, const Imath::Vec3<std::uint32_t>& triangle, const V2f& b) {
  return values[triangle.x] * (1 - b.x - b.y) + values[triangle.y] * b.x + values[triangle.z] * b.y;
}

// Placements are affine: no division by w. Directions transform by the linear part, normals by its inverse
// transpose.
inline V3f transform_point(const V3f& p, const M44f& m) {
  return {p.x * m[0][0] + p.y * m[1][0] + p.z * m[2][0] + m[3][0],
          p.x * m[0][1] + p.y * m[1][1] + p.z * m[2][1] + m[3][1],
          p.x * m[0][2] + p.y * m[1][2] + p.z * m[2][2] + m[3][2]};
}

// The inverse transpose is the cofactor matrix over the determinant; only the latter's sign matters to a
// vector that is normalised afterwards. Its rows, with that sign.
struct NormalTransform {
  V3f yz, zx, xy;
  V3f operator()(const V3f& n) const { return yz * n.x + zx * n.y + xy * n.z; }
};
inline NormalTransform normal_transform(const M44f& m) {
  const V3f x(m[0][0], m[0][1], m[0][2]);
  const V3f y(m[1][0], m[1][1], m[1][2]);
  const V3f z(m[2][0], m[2][1], m[2][2]);
  const V3f yz = y.cross(z);
  const float sign = x.dot(yz) < 0 ? -1.0F : 1.0F;
  return {yz * sign, z.cross(x) * sign, x.cross(y) * sign};
}

inline float largest_coordinate(const V3f& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }

// The shading normal on the side of the ray, from that of the front, for a surface whose front and ng are known.
inline V3f facing_normal(const Surface& surface, const V3f& front_ns, const V3f& ray_direction) {
  V3f ns = surface.front ? front_ns : -front_ns;
  if (ns.dot(surface.ng) <= 0) ns = surface.ng;
  // A shading normal that faces away from the ray's origin would leave the surface black there, as specks
  // along silhouettes: it is bent until it just faces it.
  constexpr float least_cosine = 0.01F;
  const float cosine = -ns.dot(ray_direction);
  if (cosine < least_cosine && -surface.ng.dot(ray_direction) > cosine)
    ns = (ns - ray_direction * (least_cosine - cosine)).normalized();
  return ns;
}

}  // namespace ivory
