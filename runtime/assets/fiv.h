// FIV occluder tables in OpenGL: all tables of a scene in one 3D texture, occluders in a uniform buffer
// (shaders/fiv/table.glsl, fiv/light.glsl, ambient/fiv.glsl).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "grid/fiv/set.h"
#include "runtime/assets/difmap.h"
#include "runtime/assets/sh9.h"
#include "runtime/gl/gl.h"

namespace ivory {

// Sizes of the arrays in shaders/ambient/fiv.glsl.
inline constexpr int fiv_max_tables = 64;
inline constexpr int fiv_max_occluders = 256;

// Binding points of the uniform buffers, but in a sum (ambient.h), where each slot has points of its own from 10 on.
inline constexpr int fiv_tables_binding = 8;
inline constexpr int fiv_occluders_binding = 9;

struct FivUploadParams {
  bool half_floats = false;  // RGBA16F instead of RGBA32F: half the memory, moments to 2^-11
};

// An occluder where it stands: a table may have many. Moved and evenly scaled; turned about +Y where there are tables
// of its turns (grid/fiv/set.h).
struct GpuFivOccluder {
  int table = 0;          // or set of turns: number of the file
  V3f center_m{0, 0, 0};  // of the bounding sphere, in the world
  float radius_m = 1;
  float turn_rad = 0;  // about +Y, against how the mesh was baked
};

struct GpuFivTables {
  gl::Texture atlas;
  gl::Texture spheres;
  gl::Buffer tables;
  gl::Buffer occluders;
  struct Set {
    int first = 0;  // table
    int turns = 1;
  };
  std::vector<Set> sets;           // one a table or set that was uploaded
  float environment_turn_rad = 0;  // as set_occluders() was told
  bool turns() const;              // has any of them several tables?
  std::size_t bytes() const;       // of textures and buffers
};

// Needs a current context. One to fiv_max_tables tables, of any sizes, with one or six hemispheres; no occluders yet.
// Throws Error where the context's limits do not hold them, and where two spheres of a table are less than a thousandth
// of its range (in log r) apart; `names`, one a table or none, name tables there.
GpuFivTables upload(std::span<const FivTable> tables, const FivUploadParams& params = {},
                    std::span<const std::string> names = {});

// The same of sets of turns; fiv_max_tables tables in all.
GpuFivTables upload(std::span<const FivSet> sets, const FivUploadParams& params = {},
                    std::span<const std::string> names = {});

// read_fiv_set() and upload(): throws Error as they do, naming the file.
GpuFivTables load_fiv_tables(std::span<const std::string> paths, const FivUploadParams& params = {});

// Can an occluder of that table stand turned so under an environment that is turned by environment_turn_rad? Where the
// two differ it needs a set of turns.
bool can_turn(const GpuFivTables& fiv, const GpuFivOccluder& occluder, float environment_turn_rad = 0);

// Replaces all occluders, in the order that `self` counts them, and turns the environment of the tables about +Y,
// against how they were baked; cheap enough for every frame. The unshadowed light has a turn of its own
// (GpuDifMap::turn_rad, GpuSh9::turn_rad), to be set beside it. Throws Error for more than fiv_max_occluders, and for
// one that can_turn() says no of.
void set_occluders(GpuFivTables& fiv, std::span<const GpuFivOccluder> occluders, float environment_turn_rad = 0);

// #define lines to put before shaders/ambient/fiv.glsl; `self`: for objects that are occluders themselves; `turns`:
// where there is a set of turns.
std::string fiv_defines(FivOverlap overlap, bool self, bool turns = false);

// Bind three textures from `first_unit` on and the uniform buffers, and set the uniforms of shaders/ambient/fiv.glsl;
// make the program current. `unshadowed`: of the environment that the tables were baked under. `self`: index of the
// occluder that what is drawn next is, or -1; between objects program.set("ivory_fiv_self", i) is enough. Return the
// next free unit.
int bind(const GpuFivTables& fiv, const GpuDifMap& unshadowed, gl::Program& program, int first_unit,
         Straddling straddling = Straddling::bound, int self = -1);
int bind(const GpuFivTables& fiv, const GpuSh9& unshadowed, gl::Program& program, int first_unit,
         Straddling straddling = Straddling::bound, int self = -1);

// For the renderer, one for each object with a `self` of its own; the assets must outlive it.
AmbientSource ambient(const GpuFivTables& fiv, const GpuDifMap& unshadowed, const FivLightParams& params = {},
                      int self = -1);
AmbientSource ambient(const GpuFivTables& fiv, const GpuSh9& unshadowed, const FivLightParams& params = {},
                      int self = -1);

}  // namespace ivory
