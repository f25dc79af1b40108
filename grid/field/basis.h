// Directional bases: K functions f_k(w), the moments m_k = integral of L f_k dw that a grid vertex stores, and the
// reconstruction of E(n) from them. All share one shape, so that the grid, the photon tracer, the files and the charts
// treat them alike.
#pragma once

#include <array>
#include <span>

#include "grid/base/names.h"
#include "grid/base/types.h"

namespace ivory {

enum class Basis {
  vectors,       // six hemispherical irradiance vectors (RR-6983), 12 independent numbers
  vectors9,      // their symmetrised form: F, S_i, C_ij
  sh9,           // real spherical harmonics to band 2 (Ramamoorthi & Hanrahan 2001)
  ambient_cube,  // E along the six axes
  sh4,           // spherical harmonics to band 1
};
template <>
inline constexpr auto name_table<Basis> = make_name_table<Basis>("basis", {{Basis::vectors, "vectors"},
                                                                           {Basis::vectors9, "vectors9"},
                                                                           {Basis::sh9, "sh9"},
                                                                           {Basis::ambient_cube, "ambient_cube"},
                                                                           {Basis::sh4, "sh4"}});

enum class Reconstruction {
  optimal,  // least squares, exact in uniform light, clamped into the convexity bracket [LB, UB]
  paper,    // RR-6983 section 4.1: I_x n_x^2 + I_y n_y^2 + I_z n_z^2; vectors only
};
template <>
inline constexpr auto name_table<Reconstruction> = make_name_table<Reconstruction>(
    "reconstruction", {{Reconstruction::optimal, "optimal"}, {Reconstruction::paper, "paper"}});

// Can E(n) be had so from moments of that basis?
constexpr bool reads(Reconstruction reconstruction, Basis basis) {
  return reconstruction == Reconstruction::optimal || basis == Basis::vectors;
}

inline constexpr int max_functions = 12;
inline constexpr auto all_bases = values_of<Basis>();

// Functions per colour channel as kept in memory: 12, 9, 9, 6, 4.
int function_count(Basis basis);

// The functions at unit direction w, in stored order; zero beyond function_count(basis):
//   vectors       F_xyz, then D_x, D_y, D_z (three each), D_i = sgn(w_i) w
//   vectors9      F_xyz, S_xyz, C_xy, C_xz, C_yz
//   sh9, sh4      Y_00, Y_1-1, Y_10, Y_11, Y_2-2, Y_2-1, Y_20, Y_21, Y_22
//   ambient_cube  max(0, +x), max(0, -x), max(0, +y), ...
std::array<float, max_functions> eval(Basis basis, const V3f& w);

// E(n) in lux per colour channel from moments laid out [function][rgb], function_count(basis) x 3 floats in lux; n is a
// unit vector. Never negative. Throws ParameterError for `paper` on a basis other than vectors.
Rgb irradiance(Basis basis, Reconstruction reconstruction, const float* moments, const V3f& n);

// Bounds on E(n), lux, that follow from the six vectors alone (convexity of max(0, n.w) over each hemisphere); their
// gap certifies the directional error. Takes the 36 moments of Basis::vectors, [function][rgb], and a unit vector.
struct IrradianceBracket {
  Rgb lower;
  Rgb upper;
};
IrradianceBracket irradiance_bracket(const float* moments, const V3f& n);

// The hemispherical irradiance vectors of the paper, [hemisphere +x,-x,+y,-y,+z,-z][xyz][rgb] in lux, from the stored F
// and D, [function][rgb]; and back.
std::array<float, 54> hemispheres_from_moments(std::span<const float, 36> moments);
std::array<float, 36> moments_from_hemispheres(std::span<const float, 54> hemispheres);

}  // namespace ivory
