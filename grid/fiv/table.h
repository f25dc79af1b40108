// FIV occluder tables: the light of an environment that a moving object hides, as vectors, tabulated over the
// receiver's position around it (Michael & Chrysanthou, "Fullsphere Irradiance Factorization for Real-Time
// All-Frequency Illumination for Dynamic Scenes", Computer Graphics Forum 29(8), 2010).
//
// A sample holds, per colour channel, FIV = integral of L w dw over the hidden directions (eq. 9), or, with six
// hemispheres, the moments of Basis::vectors over them: the FIV and what splits it into the hemispheres about the axes.
// A receiver's normal is not needed until the table is read.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "grid/base/metadata.h"
#include "grid/base/names.h"
#include "grid/base/types.h"
#include "grid/field/basis.h"

namespace ivory {

// What tells an occluder's shape and how it is turned, whatever its place and size: its surface area over the square of
// the bounding radius, then first and second moments of the surface about the sphere's centre over that area, in
// bounding radii (x, y, z, xx, yy, zz, xy, xz, yz), then how far it reaches from the centre along 26 directions, in
// bounding radii: those (x, y, z)/|(x, y, z)| with each of x, y, z -1, 0 or 1 and not all 0, x running fastest. Moments
// alone are those of a sphere for anything as even as a cube, however it is turned.
inline constexpr std::size_t fiv_moment_count = 10;
inline constexpr std::size_t fiv_reach_count = 26;
using FivShape = std::array<float, fiv_moment_count + fiv_reach_count>;

// [function][rgb] of Basis::vectors; a table of one hemisphere has F alone and leaves the rest zero.
using FivMoments = std::array<float, 36>;

struct FivTable {
  V3i size{0, 0, 0};          // samples in azimuth (>= 3), polar angle (>= 2), distance (>= 2)
  int hemispheres = 1;        // 1: the FIV; 6: the moments of the six-vector basis
  V3f center_m{0, 0, 0};      // of the occluder's bounding sphere, in its mesh's space
  float radius_m = 1;         // of that sphere
  std::vector<float> radii;   // of the sample spheres over radius_m, ascending, positive
  std::vector<float> values;  // distance x polar x azimuth x functions x rgb
  FivMoments total{};         // of the whole environment (FIV_tot, eq. 12)
  float coverage = 1;         // mean share of the bounding sphere's disc that the occluder fills
  FivShape shape{};           // of the occluder
  Metadata metadata;
};

// Vectors a sample: 3 numbers per channel for one hemisphere, 12 for six.
inline int fiv_function_count(int hemispheres) { return hemispheres == 1 ? 3 : 12; }
inline std::size_t fiv_sample_count(const FivTable& table) {
  return std::size_t(table.size.x) * std::size_t(table.size.y) * std::size_t(table.size.z);
}

// The table of one hemisphere that a table of six holds.
FivTable first_hemisphere(const FivTable& six);

// Unit direction from the occluder's centre to the samples of that azimuth and polar index, in double. Every sphere is
// laid out as a lat-long environment map is (rows from +Y to -Y, -Z at both ends, +X before the middle), with samples
// on both poles.
V3d fiv_sample_direction(const V3i& size, int azimuth, int polar);

// How much the whole bounding sphere would hide from distance r (in its radii): the square of the sine of its
// half-angle, to which its FIV in uniform light is proportional; 1 inside. Samples are interpolated after division by
// it, which makes them level along the distance.
inline float fiv_falloff(float r) { return r > 1 ? 1 / (r * r) : 1; }

// Moments hidden from a receiver at `q`, its position relative to the occluder's centre in bounding radii. Trilinear in
// azimuth, polar angle and distance; beyond the last sphere and within the first they follow fiv_falloff() from there.
FivMoments lookup(const FivTable& table, const V3f& q);

// How the light hidden from a receiver follows from the moments where the occluder reaches below the receiver's plane.
enum class Straddling {
  bound,  // six hemispheres: the lower bound of irradiance_bracket(); one: n.FIV where positive
  scale,  // the paper's: n.FIV (d + R) / 2R
};
template <>
inline constexpr auto name_table<Straddling> =
    make_name_table<Straddling>("straddling", {{Straddling::bound, "bound"}, {Straddling::scale, "scale"}});

// Irradiance in lux that the occluder takes from a receiver of unit normal n; `d` is the height of the occluder's
// centre over the receiver's plane in bounding radii. n.FIV for d >= 1, nothing for d <= -1 (section 4.3.1, cases A and
// C), between the two by `straddling`. Never negative.
Rgb hidden_irradiance(const FivTable& table, const FivMoments& hidden, const V3f& n, float d, Straddling straddling);

// Irradiance that the occluder leaves to a point of its own surface. One hemisphere: n.(FIV_tot - FIV) (eq. 12), as all
// light that is left comes from above the surface. That of neighbouring samples need not, and counts as negative; six
// hemispheres are read by the lower bound of irradiance_bracket(), which leaves it out. Never negative.
Rgb self_shadowed_irradiance(const FivTable& table, const FivMoments& hidden, const V3f& n);

}  // namespace ivory
