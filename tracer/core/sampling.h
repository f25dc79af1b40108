// Mappings from the unit square, u in [0, 1)^2, to directions and points, and the frames they live in.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "grid/base/circle.h"
#include "grid/base/types.h"

namespace ivory {

// Three orthonormal vectors, z the normal of a surface or the axis of a lobe.
struct ShadingFrame {
  V3f x, y, z;

  V3f to_local(const V3f& w) const { return {w.dot(x), w.dot(y), w.dot(z)}; }
  V3f to_world(const V3f& w) const { return x * w.x + y * w.y + z * w.z; }
};

// One whose z is the given unit vector. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
inline ShadingFrame make_shading_frame(const V3f& z) {
  const float sign = std::copysign(1.0F, z.z);
  const float a = -1.0F / (sign + z.z);
  const float b = z.x * z.y * a;
  return {{1.0F + sign * z.x * z.x * a, sign * b, -sign * z.x}, {b, sign + z.y * z.y * a, -z.y}, z};
}

// Uniform over the unit disc.
inline V2f sample_disc(const V2f& u) { return V2f(on_unit_circle(double(u.y))) * std::sqrt(u.x); }

// The same such that squares become compact pieces of the disc of the same share of its area: Shirley & Chiu, "A Low
// Distortion Map Between Disk and Square", Journal of Graphics Tools 2(3), 1997. u in [0, 1)^2.
inline Imath::V2d sample_disc_compact(const Imath::V2d& u) {
  const double a = 2 * u.x - 1;
  const double b = 2 * u.y - 1;
  if (a == 0 && b == 0) return {0, 0};
  const bool along_a = std::abs(a) > std::abs(b);
  const double turns = along_a ? b / a / 8 : 0.25 - a / b / 8;
  return on_unit_circle(turns) * (along_a ? a : b);
}

// Unit direction around +z with density cos/pi; z > 0 always.
inline V3f sample_cosine_hemisphere(const V2f& u) {
  const V2f d = sample_disc(u);
  // 1 - r^2 = 1 - u.x, which is at least 2^-24 because u.x < 1.
  return {d.x, d.y, std::sqrt(1.0F - u.x)};
}

// Unit direction at cosine c, -1 to 1, from +z and azimuth 2 pi u.
inline V3f direction_at_cosine(float c, float u) {
  const float s = std::sqrt(std::max(0.0F, (1.0F - c) * (1.0F + c)));
  const V2f around = V2f(on_unit_circle(double(u))) * s;
  return {around.x, around.y, c};
}

// Uniform over the sphere of directions.
inline V3f sample_sphere(const V2f& u) { return direction_at_cosine(1.0F - 2.0F * u.x, u.y); }

// Barycentric weights of the 2nd and 3rd vertex, uniform over the triangle's area.
inline V2f sample_triangle(const V2f& u) {
  const float s = std::sqrt(u.x);
  return {s * (1.0F - u.y), s * u.y};
}

}  // namespace ivory
