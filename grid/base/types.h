// The vocabulary types of ivory. Imath is the one third party allowed in shared headers.
//
// Conventions (never varied by a flag): right-handed world, +Y up, metres; linear Rec.709 colour; w points from the
// receiver towards the light; E is irradiance in lux, never divided by pi; L is radiance in nits (cd/m^2).
#pragma once

#include <cstdint>

#include <ImathBox.h>
#include <ImathColor.h>
#include <ImathMatrix.h>
#include <ImathVec.h>

namespace ivory {

using V2f = Imath::V2f;
using V3f = Imath::V3f;
using V3d = Imath::V3d;
using V3i = Imath::V3i;
using V4f = Imath::V4f;
using M33f = Imath::M33f;
using M44f = Imath::M44f;
using Box3f = Imath::Box3f;
using Rgb = Imath::C3f;

inline constexpr float pi = 3.14159265358979323846F;

// Of linear Rec.709 colour, in its unit (Y of CIE XYZ).
inline float luminance(const Rgb& c) { return 0.2126F * c.x + 0.7152F * c.y + 0.0722F * c.z; }
// The largest of r, g, b.
inline float max_component(const Rgb& c) {
  const float xy = c.x > c.y ? c.x : c.y;
  return xy > c.z ? xy : c.z;
}
// Exactly zero in all three channels.
inline bool is_black(const Rgb& c) { return c.x == 0 && c.y == 0 && c.z == 0; }

}  // namespace ivory
