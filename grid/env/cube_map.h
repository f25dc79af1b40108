// Cube maps of directions: six square faces in the order +X, -X, +Y, -Y, +Z, -Z, each as seen from the centre of the
// cube, never mirrored. Rows run downwards.
//
//   face   right   down
//   +X     +Z      -Y
//   -X     -Z      -Y
//   +Y     +X      -Z
//   -Y     +X      +Z
//   +Z     -X      -Y
//   -Z     +X      -Y
//
// These are the faces of an OpenEXR file with envmap = cube, which stacks them in that order from top to bottom. Texels
// are areas here: their edges divide the face evenly, their centres lie half a texel inside (OpenEXR's own sampling
// functions put the outer texels' centres on the edges).
//
// An OpenGL cube map shows its faces from outside: the same texels with the columns of +-X and +-Z and the rows of +-Y
// in reverse.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "grid/base/types.h"

namespace ivory {

struct CubeMap {
  int size = 0;             // texels along an edge of a face, at least 1
  std::vector<Rgb> texels;  // 6 * size * size: face, row, column
};

inline constexpr int cube_faces = 6;

// The unit vectors of a face: what it looks at, and where its columns and rows grow.
struct CubeFaceAxes {
  V3f forward;
  V3f right;
  V3f down;
};
const CubeFaceAxes& cube_face_axes(int face);  // 0 to 5, in the order above

// A point of a face: s to the right, t down, each in [-1, 1], 0 in the middle.
struct CubePosition {
  int face = 0;
  float s = 0;
  float t = 0;
};

// The point of the cube [-1, 1]^3 there (not normalised); s and t in double, for exact texel edges.
V3d cube_point(int face, double s, double t);

// The face that w leaves through and where; w need not be normalised. On an edge or a corner the X faces come before
// the Y faces and these before the Z faces, as in OpenEXR. {0, 0, 0} gives the middle of +X.
CubePosition cube_position(const V3f& w);

// s or t of the edge before texel i of `size`: i = 0 .. size gives -1 .. 1, exactly symmetric.
inline double cube_edge(int size, int i) { return double(2 * i - size) / size; }

inline std::size_t cube_index(int size, int face, int row, int column) {  // into texels: face, row, column
  return (std::size_t(face) * std::size_t(size) + std::size_t(row)) * std::size_t(size) + std::size_t(column);
}

// Unit direction of a texel's centre.
V3f cube_texel_direction(int size, int face, int row, int column);

// Index of the texel that w falls in.
std::size_t cube_texel(int size, const V3f& w);

// Solid angle of a texel in steradians; the same for all faces. The 6 size^2 of them sum to 4 pi.
double cube_texel_solid_angle(int size, int row, int column);

// The texels of a bilinear look-up and their weights, which sum to one. Across an edge the neighbouring face's texels
// are read; where three faces meet, the fourth texel that a corner lacks is the mean of the other three: what OpenGL
// does with seamless cube maps.
struct CubeTaps {
  std::array<std::size_t, 4> texel;
  std::array<float, 4> weight;
};
CubeTaps cube_taps(int size, const V3f& w);  // w of any length

// Bilinear and continuous over the whole sphere.
Rgb bilinear(const CubeMap& map, const V3f& w);

}  // namespace ivory
