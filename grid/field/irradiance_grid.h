// A baked irradiance-vector grid in memory: where its vertices stand, what each stores, and E(p, n).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "grid/field/basis.h"

namespace ivory {

// Vertices stand at integer index coordinates 0 .. size-1, each in the middle of its cell, the box of
// one voxel around it: the grid covers index coordinates -1/2 .. size-1/2. Index (i,j,k) lies at
// origin + (i spacing.x, j spacing.y, k spacing.z) * local_to_world (Imath row vectors).
struct GridFrame {
  V3i size{0, 0, 0};       // vertices per axis, each at least 2
  V3f origin_m{0, 0, 0};   // world position of vertex (0,0,0)
  V3f spacing_m{1, 1, 1};  // along the grid's own axes
  M33f local_to_world;     // rotation; rows are the grid's axes in world space. Stored vectors live in the local frame

  std::size_t vertex_count() const { return std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z); }
  // x runs fastest.
  std::size_t vertex_index(int i, int j, int k) const {
    return (std::size_t(k) * std::size_t(size.y) + std::size_t(j)) * std::size_t(size.x) + std::size_t(i);
  }
  V3f to_index(const V3f& p_world) const { return direction_to_local(p_world - origin_m) / spacing_m; }
  V3f to_world(const V3f& p_index) const { return origin_m + direction_to_world(p_index * spacing_m); }
  // local_to_world is a rotation, so its transpose is its inverse.
  V3f direction_to_local(const V3f& w) const {
    const M33f& m = local_to_world;
    return {w.x * m[0][0] + w.y * m[0][1] + w.z * m[0][2], w.x * m[1][0] + w.y * m[1][1] + w.z * m[1][2],
            w.x * m[2][0] + w.y * m[2][1] + w.z * m[2][2]};
  }
  V3f direction_to_world(const V3f& w) const { return w * local_to_world; }
};

// What a vertex can see around it, in 16 bytes; see guard.h. All zero: sees everything.
struct GuardRecord {
  std::array<std::uint32_t, 4> words{};
  bool operator==(const GuardRecord&) const = default;
};

struct IrradianceGrid {
  GridFrame frame;
  Basis basis = Basis::vectors;
  std::vector<float> moments;  // [vertex][function][rgb], lux
  // Fraction of the vertex's cell, in 64ths, that the vertex sees; 0 marks a vertex that stores nothing (buried in a
  // wall, or not kept).
  std::vector<float> visible_fraction;
  // Variance of one measurement of E at the vertex, lux^2 per channel: photon noise, estimated for
  // light spread over the receiver's hemisphere.
  std::vector<Rgb> variance;
  std::vector<GuardRecord> guard;  // empty: baked with --guard off
  Metadata metadata;

  int stride() const { return function_count(basis) * 3; }
  const float* at(std::size_t vertex) const { return moments.data() + vertex * std::size_t(stride()); }
};

enum class Interpolation { trilinear, tricubic };
enum class Guard { off, planes, rays };
std::string_view name(Guard guard);
Guard guard_from_name(std::string_view name);

// The vertices that a lookup reads and their interpolation weights, which add up to one.
struct Footprint {
  int count = 0;  // 8 trilinear, 64 tricubic, 72 a blend of both
  std::array<std::uint32_t, 72> vertex;
  std::array<float, 72> weight;
};

struct LookupParams {
  Interpolation interpolation = Interpolation::trilinear;
  Reconstruction reconstruction = Reconstruction::optimal;
  float nudge_voxels = 0.25F;  // p moves along n by this fraction of a voxel before it is looked up
};

// Footprint of p (world); beyond the outermost vertices the nearest ones are repeated.
Footprint make_footprint(const GridFrame& frame, const V3f& p, Interpolation interpolation);

// How much a vertex that sees that fraction of its cell counts, 0 to 1: one that sees less than a quarter knows less of
// what is around it.
float vertex_trust(float visible_fraction);

// Sets the weights of vertices that store nothing, and of those whose visibility bit is not set (bit i for
// entry i; all ones for no guard), to zero and renormalises the others. Returns the share of the weight that
// was kept: 0, and nothing changed, where next to nothing would be left.
float restrict_footprint(const IrradianceGrid& grid, std::uint64_t visible, Footprint& footprint);

// Both footprints in one, `share` of it from a; at most 72 entries together.
Footprint blend(const Footprint& a, const Footprint& b, float share);

// E(n), n a unit world vector, from an (already restricted) footprint: lux per channel.
Rgb irradiance(const IrradianceGrid& grid, const Footprint& footprint, const V3f& n, Reconstruction reconstruction);

// Standard error of that E from photon noise alone, lux per channel; what the grid's resolution and the basis do to E
// is no part of it. It is an estimate with two known biases: vertices are taken as independent, though one photon's
// track passes several of those around a point (too low), and all photons count a third, though those from behind the
// receiver count nothing (too high). In a closed room with and without direct light, and on a plane under a sun, the
// spread over seeds came to 0.71 to 0.81 of it, on the whole; at single points to between a half and 1.1 of it.
Rgb irradiance_standard_error(const IrradianceGrid& grid, const Footprint& footprint);

}  // namespace ivory
