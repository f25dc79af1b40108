// A baked irradiance grid on the GPU: three 3D textures and a few numbers, read by shaders/field/irradiance_grid.glsl.
//
// All functions of the basis (12, 9, 9, 6 or 4 volumes of RGB16F) lie side by side in one texture, so that a grid takes
// one texture unit for them, and not twelve of the sixteen that OpenGL 3.3 promises. Coordinates stay within the
// outermost vertices' centres, where linear filtering reads no texel of the neighbouring volume. Vertices' values are
// stored times their trust, min(1, visible fraction / 0.25): what the hardware's filter returns, divided by the
// filtered trust, is then the same weighted mean that the C++ code forms. Values are divided by a power of two, so that
// the brightest lies near half's largest number and values 2^28 below it keep half's full precision.
//
// Two forms of the six irradiance vectors take the same memory, 72 bytes a vertex (288 KiB for 16^3):
//   moments               F, D_x, D_y, D_z: the twelve independent functions. Loses half's rounding only (1e-4 to 2e-4
//                         of E, root mean square, in baked scenes), and filters linearly; the default.
//   norms_and_directions  RR-6983's: six hemispheres' norms (RGB) and directions. Loses what the colour channels'
//                         directions differ by (2e-3 in a grey room, 0.04 in one with coloured walls, 0.16 in a
//                         garden), and does not filter linearly.
// Beside them 16 bytes a vertex of guard (RGBA32UI; one texel in all where the grid has none) and 2 of trust (R16F,
// exact for the bakers' visible fractions, multiples of 1/64); and in grids of several levels 4 bytes a brick that a
// level could have, for the tables that find them. The order of a guard record's words tells whether any
// light came to the vertex: the first is not less than the last where it did.
#pragma once

#include <cstddef>
#include <string>

#include "grid/field/irradiance_grid.h"
#include "runtime/assets/ambient.h"
#include "runtime/assets/grid_atlas.h"
#include "runtime/gl/gl.h"

namespace ivory {

enum class GridForm { moments, norms_and_directions };

struct GridUploadParams {
  GridForm form = GridForm::moments;  // bases other than vectors have moments only
};

struct GpuGrid {
  gl::Texture volumes;
  gl::Texture trust;
  gl::Texture guard;
  GridFrame frame;  // of the coarsest level
  int levels = 1;
  GridAtlas atlas;
  V3d anchor_m{0, 0, 0};  // shaders are to be given positions less this: grid/base/anchor.h
  Basis basis = Basis::vectors;
  GridForm form = GridForm::moments;
  V3i tiles{1, 1, 1};  // volume f is tile (f % x, f / x % y, f / (x y)) of the texture
  float scale = 1;     // lux a stored unit, a power of two
  bool guarded = false;

  std::size_t volume_bytes() const { return volumes.bytes(); }
  std::size_t bytes() const { return volumes.bytes() + trust.bytes() + guard.bytes(); }
};

// Needs a current context. Throws Error naming `what` where the grid is larger than the context takes, and
// ParameterError for norms_and_directions of a basis other than vectors.
GpuGrid upload(const IrradianceGrid& grid, const GridUploadParams& params = {},
               const std::string& what = "irradiance grid");

// read_grid_vdb() and upload(): throws as they do, naming the file.
GpuGrid load_grid(const std::string& path, const GridUploadParams& params = {});

// Shaders read a grid without guard by Guard::planes as by Guard::off; there are no rays on the GPU.

// Sets what shaders/ambient/grid.glsl declares, makes the program current, binds three textures from unit `first_unit`
// on, and returns the unit after them. Throws ParameterError for `paper` on a basis other than vectors and for
// Guard::rays.
int bind(const GpuGrid& grid, gl::Program& program, int first_unit, const LookupParams& params = {});

// Lines of #define that compile the grid's kind and the look-up's into the shader, to stand before the #include of
// ambient/grid.glsl or field/irradiance_grid.glsl. Without them the shader reads both from uniforms, which drivers that
// run both sides of a branch (llvmpipe) pay several times over. A program made so fits grids of that kind only.
std::string grid_defines(const GpuGrid& grid, const LookupParams& params = {});

// For objects that the grid lights, wherever they stand: the shader compiled for this kind of grid and look-up. Refers
// to the grid.
AmbientSource ambient(const GpuGrid& grid, const LookupParams& params = {});

}  // namespace ivory
