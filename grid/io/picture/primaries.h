// Colours of other primaries than Rec.709's, brought to it.
#pragma once

#include "grid/base/types.h"

namespace ivory {

// CIE 1931 xy of what (1, 0, 0), (0, 1, 0), (0, 0, 1) and (1, 1, 1) show.
struct Primaries {
  Imath::V2d red{0.64, 0.33};
  Imath::V2d green{0.30, 0.60};
  Imath::V2d blue{0.15, 0.06};
  Imath::V2d white{0.3127, 0.3290};
};

// CIE XYZ itself, whose white point is a matter of form.
inline constexpr Primaries xyz_primaries{{1, 0}, {0, 1}, {0, 0}, {1.0 / 3, 1.0 / 3}};

// Rec.709's as files round them, or what comes to the same: those of ICC profiles are adapted to D50. To within 0.002
// of a colour.
bool is_rec709(const Primaries& primaries);

// The linear map from colours of those primaries to linear Rec.709: out[i] = sum over j of m[i][j] in[j]. White goes to
// white (Bradford's adaptation); XYZ, which names colours rather than a display's, is kept as it is, so that Y is the
// luminance of the result. Throws std::invalid_argument where the primaries span no space of colours.
Imath::M33d to_rec709(const Primaries& primaries);

// m applied to a colour.
V3d transformed(const Imath::M33d& m, const V3d& color);

// The nearest colour without negative components on the way to grey of the same luminance; black where that is not
// positive. Colours without negative components stay as they are.
Rgb within_gamut(const V3d& color);

}  // namespace ivory
