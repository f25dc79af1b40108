// Localized cube maps: a few large texels of radiance around a reference point, each with the distances of its four
// corners, so that the light at points beside the reference point is that of the surfaces, not of a far environment
// (Umenhoffer and Szirmay-Kalos: Robust Diffuse Final Gathering on the GPU, WSCG 2007).
//
// The corners of all texels, at their distances, are the vertices of a closed shell of triangles around the reference
// point. A texel's radiance leaves its two triangles evenly, in all directions.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "grid/base/names.h"
#include "grid/base/types.h"
#include "grid/env/cube_map.h"

namespace ivory {

// A corner is a point q of the cube's surface, |q|_max = 1, and the shell's vertex there is origin + q / inverse_depth:
// inverse_depth is 1 / the largest coordinate of the vertex relative to the origin, in 1/m, and 0 for the sky. It is
// linear in q over any plane, which distances are not. Along seams both faces have the same q, so that one number
// serves both.
using TexelCorners = std::array<float, 4>;  // (u, v) = (0,0), (1,0), (0,1), (1,1): right, then down in the face

struct LocalizedCube {
  V3f origin_m{0, 0, 0};
  V3d anchor_m{0, 0, 0};              // origin_m plus this is in the world: grid/base/anchor.h
  CubeMap radiance;                   // nits
  std::vector<TexelCorners> corners;  // as radiance.texels; texels that share a corner hold the same number
  Metadata metadata;
};

// Ranges of what a cube map holds: nearer corners count as this near, brighter texels are refused.
inline constexpr float least_depth_m = 1e-6F;
inline constexpr float greatest_radiance_nits = 1e30F;
// Texels along an edge: each look-up runs over all of them, so cube maps are small.
inline constexpr int largest_localized_size = 64;

enum class CubeMethod {
  convolved,      // distances ignored: E(origin, n), whatever p
  point,          // each texel a small patch at its centre; grows without bound as p nears it
  polygon,        // Lambert's formula for polygons cut at the receiver's horizon
  polygon_paper,  // the same, not cut: a texel whose sum is negative counts as 0
};
template <>
inline constexpr auto name_table<CubeMethod> =
    make_name_table<CubeMethod>("way to read a cube map", {{CubeMethod::polygon, "polygon"},
                                                           {CubeMethod::polygon_paper, "polygon_paper"},
                                                           {CubeMethod::point, "point"},
                                                           {CubeMethod::convolved, "convolved"}});

// E in lux at p (world, m, less the anchor) for unit normal n. Nothing shadows a texel: neither the receiver nor
// another texel. Never negative and always finite. A point outside of the shell, or within a thousandth of it, reads
// the light of the point on its line to the origin that lies a thousandth inside; a point that is not finite reads the
// origin's. By `polygon` and `convolved` E is at most pi times the greatest radiance, and exactly pi L inside a shell
// of constant radiance L.
Rgb irradiance(const LocalizedCube& cube, CubeMethod method, const V3f& p, const V3f& n);

// Places it relative to another anchor; in the world it stays where it is.
void set_anchor(LocalizedCube& cube, const V3d& anchor_m);

// `offset` = p - origin, brought inside the shell as irradiance() does.
V3f inside_shell(const LocalizedCube& cube, const V3f& offset);

// The vertices of the shell: for each texel and each of its four corners the index of its vertex, from 0 to 6 size^2 +
// 1, the same for all texels that meet there.
std::vector<std::uint32_t> corner_vertices(int size);

// What is wrong with a cube map, empty for nothing: sizes, ranges, corners that neighbours disagree about.
std::string find_fault(const LocalizedCube& cube);

}  // namespace ivory
