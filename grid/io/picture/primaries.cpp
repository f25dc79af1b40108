#include "grid/io/picture/primaries.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ivory {

namespace {

using Imath::M33d;
using Imath::V2d;

bool near(const V2d& a, const V2d& b) { return std::abs(a.x - b.x) <= 1e-3 && std::abs(a.y - b.y) <= 1e-3; }

bool near(const Primaries& a, const Primaries& b) {
  return near(a.red, b.red) && near(a.green, b.green) && near(a.blue, b.blue) && near(a.white, b.white);
}

V3d xyz_of_white(const V2d& white) { return {white.x / white.y, 1, (1 - white.x - white.y) / white.y}; }

M33d inverse_of(const M33d& m) {
  const M33d inverse = m.inverse();
  // Imath gives the unit matrix for a singular one.
  if (std::abs(m.determinant()) < 1e-9) throw std::invalid_argument("primaries in one line");
  return inverse;
}

// SMPTE RP 177: columns are the primaries, scaled so that their sum is white.
M33d to_xyz(const Primaries& p) {
  M33d m;
  const V2d* const columns[] = {&p.red, &p.green, &p.blue};
  for (int i = 0; i < 3; ++i) {
    m[0][i] = columns[i]->x;
    m[1][i] = columns[i]->y;
    m[2][i] = 1 - columns[i]->x - columns[i]->y;
  }
  if (!(p.white.y > 1e-6)) throw std::invalid_argument("white point without luminance");
  const V3d scale = transformed(inverse_of(m), xyz_of_white(p.white));
  for (int j = 0; j < 3; ++j) {
    if (!(std::abs(scale[j]) > 1e-9)) throw std::invalid_argument("white point on the edge");
    for (int i = 0; i < 3; ++i) m[i][j] *= scale[j];
  }
  return m;
}

// Lam 1985, as ICC.1 has it: cone responses scaled from one white to the other.
M33d bradford(const V2d& from, const V2d& to) {
  const M33d cones(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296);
  const V3d a = transformed(cones, xyz_of_white(from));
  const V3d b = transformed(cones, xyz_of_white(to));
  const M33d scale(b.x / a.x, 0, 0, 0, b.y / a.y, 0, 0, 0, b.z / a.z);
  return inverse_of(cones) * scale * cones;
}

}  // namespace

M33d to_rec709(const Primaries& primaries) {
  const Primaries rec709;
  const M33d from_xyz = inverse_of(to_xyz(rec709));
  if (near(primaries, xyz_primaries)) return from_xyz;
  M33d m = from_xyz * bradford(primaries.white, rec709.white) * to_xyz(primaries);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (!std::isfinite(m[i][j])) throw std::invalid_argument("primaries that are no colours");
  return m;
}

bool is_rec709(const Primaries& primaries) {
  if (near(primaries, Primaries{})) return true;
  try {
    return to_rec709(primaries).equalWithAbsError(M33d(), 2e-3);
  } catch (const std::invalid_argument&) {
    return false;
  }
}

V3d transformed(const M33d& m, const V3d& color) {
  V3d out(0, 0, 0);
  for (int i = 0; i < 3; ++i) out[i] = m[i][0] * color.x + m[i][1] * color.y + m[i][2] * color.z;
  return out;
}

Rgb within_gamut(const V3d& color) {
  const double least = std::min({color.x, color.y, color.z});
  if (least >= 0) return Rgb(color);
  const double y = 0.2126 * color.x + 0.7152 * color.y + 0.0722 * color.z;
  if (!(y > 0)) return Rgb(0, 0, 0);
  const double keep = y / (y - least);
  const auto mixed = [&](double c) { return c == least ? 0.0F : float(std::max(0.0, y + keep * (c - y))); };
  return Rgb(mixed(color.x), mixed(color.y), mixed(color.z));
}

}  // namespace ivory
