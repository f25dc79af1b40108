// A baked irradiance-vector grid in memory: where its vertices stand, what each stores, and E(p, n).
#pragma once

#include <array>
#include <bitset>
#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "grid/base/names.h"
#include "grid/field/basis.h"
#include "grid/field/frame.h"

namespace ivory {

// What a vertex can see around it, in 16 bytes; see guard.h. All zero: it sees everything.
struct GuardRecord {
  std::array<std::uint32_t, 4> words{};
  bool operator==(const GuardRecord&) const = default;
};

// Which light is stored.
enum class StoredLight { indirect, direct_and_indirect };
template <>
inline constexpr auto name_table<StoredLight> = make_name_table<StoredLight>(
    "light", {{StoredLight::indirect, "indirect"}, {StoredLight::direct_and_indirect, "direct and indirect"}});

// What a grid and the sums that it is made from (accumulator.h) have in common.
struct GridVertices {
  GridFrame frame;
  V3d anchor_m{0, 0, 0};  // the frame's positions plus this are the world's: grid/base/anchor.h
  Basis basis = Basis::vectors;
  StoredLight light = StoredLight::indirect;
  // [vertex] fraction of the vertex's cell, in 64ths, that the vertex sees; 0 marks a vertex that stores nothing
  // (buried in a wall, or not kept).
  std::vector<float> visible_fraction;
  std::vector<GuardRecord> guard;  // [vertex]; empty: baked without guard
  Metadata metadata;
};

struct IrradianceGrid : GridVertices {
  std::vector<float> moments;  // [vertex][function][rgb], lux
  // [vertex] variance of one measurement of E, lux^2 per channel: photon noise, estimated for light spread over the
  // receiver's hemisphere.
  std::vector<Rgb> variance;

  // Floats a vertex, and where a vertex's begin.
  int stride() const { return function_count(basis) * 3; }
  const float* at(std::size_t vertex) const { return moments.data() + vertex * std::size_t(stride()); }
};

enum class Interpolation {
  trilinear,
  tricubic,  // B-spline: smoother, and blurs
  fitted,    // linear_fit.h: a linear field through the vertices around two points before the surface, at the surface
};
template <>
inline constexpr auto name_table<Interpolation> =
    make_name_table<Interpolation>("interpolation", {{Interpolation::trilinear, "trilinear"},
                                                     {Interpolation::tricubic, "tricubic"},
                                                     {Interpolation::fitted, "fitted"}});

// What keeps light from leaking through walls when a grid is read.
enum class Guard {
  off,
  planes,  // stored in the grid: guard.h
  rays,    // traced in the scene: tracer/render/guard_rays.h
};
template <>
inline constexpr auto name_table<Guard> =
    make_name_table<Guard>("guard", {{Guard::rays, "rays"}, {Guard::planes, "planes"}, {Guard::off, "off"}});

// The vertices that a look-up reads and their weights, which add up to one. Those of fit_linear() may be negative, and
// its vertices may come twice.
inline constexpr std::size_t max_footprint = 80;
struct Footprint {
  int count =
      0;  // 8 trilinear, 64 tricubic, 72 a blend of both, 8 more if fitted; 0: no vertex sees the point, and E is 0
  std::array<std::uint32_t, max_footprint> vertex;
  std::array<float, max_footprint> weight;
};

// Bit i: the vertex of entry i sees the point that is looked up.
using VisibleEntries = std::bitset<max_footprint>;

// How a grid is read.
struct LookupParams {
  Guard guard = Guard::planes;  // a grid that was baked without guard has none to read by
  Interpolation interpolation = Interpolation::trilinear;
  Reconstruction reconstruction = Reconstruction::optimal;
  float nudge_voxels = 0.25F;  // p moves along n by this fraction of a voxel before it is looked up
};

// Places the vertices relative to another anchor; in the world they stay where they are.
void set_anchor(GridVertices& grid, const V3d& anchor_m);

// Footprint of p (as the frame counts it: world, m, less the anchor). Beyond the outermost vertices the nearest ones
// are repeated. The interpolation is not `fitted`, which is made of trilinear footprints.
Footprint make_footprint(const GridFrame& frame, const V3f& p, Interpolation interpolation);

// How much a vertex that sees that fraction of its cell counts, 0 to 1: one that sees less than a quarter knows less of
// what is around it.
float vertex_trust(float visible_fraction);

// Below this, trust times weight is rounding noise once renormalised.
inline constexpr float least_weight = 1e-4F;

// Sets the weights of vertices that store nothing or do not see the point to zero, and renormalises the others. Returns
// the share of the weight that was kept: 0, and nothing changed, where next to nothing would be left.
float restrict_footprint(const IrradianceGrid& grid, const VisibleEntries& visible, Footprint& footprint);

// Both footprints in one, `share` (0 to 1) of it from a; at most max_footprint entries with a weight together.
Footprint blend(const Footprint& a, const Footprint& b, float share);

// E(n) in lux per channel, n a unit world vector, from an (already restricted) footprint. Throws ParameterError for the
// reconstruction `paper` of a basis other than vectors.
Rgb irradiance(const IrradianceGrid& grid, const Footprint& footprint, const V3f& n, Reconstruction reconstruction);

// Standard error of that E from photon noise alone, lux per channel; what the grid's resolution and the basis do to E
// is no part of it. It is an estimate with two known biases: vertices are taken as independent, though one photon's
// track passes several of those around a point (too low), and all photons count a third, though those from behind the
// receiver count nothing (too high). In a closed room with and without direct light, and on a plane under a sun, the
// spread over seeds came to 0.71 to 0.81 of it, on the whole; at single points to between a half and 1.1 of it.
// A vertex that no photon came to has the standard error unmet_lux: unmet_bound_lux() of evidence.h.
Rgb irradiance_standard_error(const IrradianceGrid& grid, const Footprint& footprint, float unmet_lux = 0);

}  // namespace ivory
