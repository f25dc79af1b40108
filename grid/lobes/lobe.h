// Cosine lobes: s max(a.w, 0)^e around a unit axis a, the one kind of function that light, reflectance and visibility
// are written in ("Solving the rendering equation with cosine lobes", technical report, XLIM laboratory); closed forms
// and moments stand where the report fits and tabulates.
//
// All pure functions on floats, to be mirrored line by line on a GPU.
#pragma once

#include "grid/base/types.h"

namespace ivory {

struct Lobe {
  V3f axis{0, 0, 1};   // unit
  float exponent = 0;  // 0 is the hemisphere
  float scale = 0;     // value along the axis
};

// The exponents that products are tabulated for.
inline constexpr float max_lobe_exponent = 100000.0F;

// 2 pi s / (e + 1): over the whole sphere.
float lobe_integral(const Lobe& lobe);

// The lobe of a cap (1 within `cos_half_angle` of the axis, 0 elsewhere; 0 to 1) with the cap's solid angle and the
// cap's vector moment, which is what a Lambert surface sees of it. Caps narrower than the largest exponent's keep their
// solid angle.
Lobe cap_lobe(const V3f& axis, float cos_half_angle);

// The same from 1 - cos(half angle), which for small caps is the better conditioned number.
Lobe cap_lobe_from_height(const V3f& axis, float height);

// The lobe of any patch of directions: solid angle over 2 pi, and 1 - mean cosine to the axis (0 to 1/2).
Lobe spread_lobe(const V3f& axis, float height, float spread);

// Half-angle of a sphere seen from distance_m > radius_m: 1 - cos, to full precision for small spheres.
float sphere_cap_height(float radius_m, float distance_m);

}  // namespace ivory
