// A baked irradiance-vector grid in memory: where its vertices stand, what each stores, and E(p, n).
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <limits>
#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "grid/base/names.h"
#include "grid/field/basis.h"
#include "grid/field/lattice.h"

namespace ivory {

// What a vertex can see around it, in 16 bytes; see guard.h. All zero: it sees everything.
struct GuardRecord {
  std::array<std::uint32_t, 4> words{};
  bool operator==(const GuardRecord&) const = default;
};

// Kinds of sources whose light is taken to come straight from them, or not.
struct DirectSources {
  bool punctual = false;  // points, spots, suns of the scene
  bool area = false;      // emissive surfaces and spherical lights
  bool sky = false;       // the environment, its sun included

  constexpr DirectSources() = default;
  constexpr DirectSources(bool all) : punctual(all), area(all), sky(all) {}  // NOLINT(google-explicit-constructor)
  constexpr explicit operator bool() const { return punctual || area || sky; }
  constexpr bool all() const { return punctual && area && sky; }
  bool operator==(const DirectSources&) const = default;
};

// Which light is stored: indirect light, and what comes straight from some kinds of sources. The values are sums of 1
// for punctual, 2 for area and 4 for the sky.
enum class StoredLight {
  indirect = 0,
  punctual = 1,
  area = 2,
  punctual_area = 3,
  sky = 4,
  punctual_sky = 5,
  area_sky = 6,
  direct_and_indirect = 7
};
template <>
inline constexpr auto name_table<StoredLight> =
    make_name_table<StoredLight>("light", {{StoredLight::indirect, "indirect"},
                                           {StoredLight::direct_and_indirect, "direct and indirect"},
                                           {StoredLight::punctual, "indirect, direct of punctual"},
                                           {StoredLight::area, "indirect, direct of area"},
                                           {StoredLight::sky, "indirect, direct of sky"},
                                           {StoredLight::punctual_area, "indirect, direct of punctual and area"},
                                           {StoredLight::punctual_sky, "indirect, direct of punctual and sky"},
                                           {StoredLight::area_sky, "indirect, direct of area and sky"}});
constexpr StoredLight stored_light(const DirectSources& direct) {
  return StoredLight((direct.punctual ? 1 : 0) + (direct.area ? 2 : 0) + (direct.sky ? 4 : 0));
}
constexpr DirectSources direct_sources(StoredLight light) {
  DirectSources direct;
  direct.punctual = (int(light) & 1) != 0;
  direct.area = (int(light) & 2) != 0;
  direct.sky = (int(light) & 4) != 0;
  return direct;
}

// What a grid and the sums that it is made from (accumulator.h) have in common: where their vertices stand, and what
// they see. Arrays by [vertex] have the lattice's vertex_count() of them.
struct GridVertices : Lattice {
  V3d anchor_m{0, 0, 0};  // the frames' positions plus this are the world's: grid/base/anchor.h
  Basis basis = Basis::vectors;
  StoredLight light = StoredLight::indirect;
  // [vertex] fraction of the vertex's cell, in 64ths, that the vertex sees; 0 marks a vertex that stores nothing
  // (buried in a wall, or not kept).
  std::vector<float> visible_fraction;
  std::vector<GuardRecord> guard;  // [vertex]; empty: baked without guard
  Metadata metadata;
};

// What is stored of light.
struct StoredMoments {
  std::vector<float> moments;  // [vertex][function][rgb], lux
  // [vertex] variance of one measurement of E, lux^2 per channel: photon noise, estimated for light spread over the
  // receiver's hemisphere.
  std::vector<Rgb> variance;
};

// Metadata of grids and sums that keep groups apart: their names.
inline constexpr const char* light_groups_key = "light_groups";
// And the group of each of the scene's punctual lights, in the scene's order.
inline constexpr const char* lamp_groups_key = "light_groups_of_lamps";

// Of the lights of one group, in a grid that keeps groups apart.
struct GridGroup : StoredMoments {
  std::string name;
};

struct IrradianceGrid : GridVertices, StoredMoments {
  // What adds up to the moments, but for rounding; empty: groups were not kept apart.
  std::vector<GridGroup> groups;

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
// its vertices may come twice. In a level 8 trilinear, 64 tricubic, 72 a blend of both, 8 more if fitted; two levels
// may meet.
inline constexpr std::size_t max_footprint = 160;
struct Footprint {
  int count = 0;      // 0: no vertex sees the point, and E is 0
  bool wide = false;  // holds vertices farther than a voxel from the point: tricubic
  std::array<std::uint32_t, max_footprint> vertex;
  std::array<float, max_footprint> weight;

  Footprint() = default;
  // Of the entries that there are: most footprints have eight.
  Footprint(const Footprint& other) { *this = other; }
  Footprint& operator=(const Footprint& other) {
    count = other.count;
    wide = other.wide;
    std::copy_n(other.vertex.begin(), count, vertex.begin());
    std::copy_n(other.weight.begin(), count, weight.begin());
    return *this;
  }
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

// A point to look up (as the frames count it: world, m, less the anchor): on a surface of unit normal ng, which each
// level leaves by a share of its own spacing, or in space, where ng is 0.
struct LookupPoint {
  V3f p;
  V3f ng{0, 0, 0};
  float nudge_voxels = 0;                                 // of the smallest spacing
  float most_m = std::numeric_limits<float>::infinity();  // but never farther than this off the surface

  float off_m(const GridFrame& level) const {
    const V3f& h = level.spacing_m;
    return std::min(nudge_voxels * std::min({h.x, h.y, h.z}), most_m);
  }
  V3f nudged(const GridFrame& level) const { return p + ng * off_m(level); }
};

// Places the vertices relative to another anchor; in the world they stay where they are.
void set_anchor(GridVertices& grid, const V3d& anchor_m);

// Footprint of p (as the frame counts it: world, m, less the anchor). Beyond the outermost vertices the nearest ones
// are repeated. The interpolation is not `fitted`, which is made of trilinear footprints.
Footprint make_footprint(const GridFrame& frame, const V3f& p, Interpolation interpolation);

// How much a look-up reads of each level. The finest level's share is the trilinear weight of those of the point's
// eight vertices that it stores, and the next level has what is left over: so a level fades towards the border of its
// bricks as the weights of the vertices beyond grow, and what is read has no jump. Coarser levels are complete around a
// brick (lattice.h): two meet at most.
struct LevelShares {
  std::array<int, 2> level{0, 0};
  std::array<float, 2> share{1, 0};  // 1 in all
};
LevelShares level_shares(const Lattice& lattice, const LookupPoint& at);

// The point's footprint in one level. Vertices that are not stored are left out, and the weights of the others add up
// to one; no entry where none is.
Footprint make_footprint(const Lattice& lattice, int level, const LookupPoint& at, Interpolation interpolation);

// All levels' footprints by their shares.
Footprint make_footprint(const Lattice& lattice, const LookupPoint& at, Interpolation interpolation);

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
// A vertex that no photon came to has the standard error unmet_lux (of the coarsest level; finer cells have smaller
// faces, and as much more): unmet_bound_lux() of evidence.h.
Rgb irradiance_standard_error(const IrradianceGrid& grid, const Footprint& footprint, float unmet_lux = 0);

}  // namespace ivory
