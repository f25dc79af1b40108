// The numbers of a baked irradiance grid, which runtime/assets/irradiance_grid.h sets. The choices among them may be
// compiled in: see field/irradiance_grid.glsl.
#ifndef IVORY_GRID_BASIS
#define IVORY_GRID_BASIS g.basis
#endif
#ifndef IVORY_GRID_FORM
#define IVORY_GRID_FORM g.form
#endif
#ifndef IVORY_GRID_GUARD
#define IVORY_GRID_GUARD g.guard
#endif
#ifndef IVORY_GRID_INTERPOLATION
#define IVORY_GRID_INTERPOLATION g.interpolation
#endif
#ifndef IVORY_GRID_RECONSTRUCTION
#define IVORY_GRID_RECONSTRUCTION g.reconstruction
#endif
#ifndef IVORY_GRID_LEVELS
#define IVORY_GRID_LEVELS g.levels
#endif
const int ivory_grid_moments = 0;  // the values of enum class GridForm
const int ivory_grid_norms_and_directions = 1;
const int ivory_trilinear = 0;  // of Interpolation
const int ivory_tricubic = 1;
const int ivory_guard_off = 0;  // of Guard
const int ivory_guard_planes = 1;

struct IvoryGrid {         // of the coarsest level, or as ivory_grid_level() gives it
  vec3 origin_m;         // world position of vertex (0,0,0)
  vec3 spacing_m;        // along the grid's own axes
  mat3 local_to_world;   // rotation: world = local_to_world * local
  ivec3 size;            // vertices
  vec3 slab[12];         // first texel of each volume
  vec3 texel;            // 1 / size of the volumes' texture
  float scale;           // lux a stored unit
  float nudge_m;         // how far p moves along ng first
  int basis;
  int form;
  int guard;
  int interpolation;
  int reconstruction;
  int levels;            // of spacing; what follows is for more than one
  ivec3 atlas_bits;      // log2 of the atlas' size in bricks along x, along y, and of a slice
  int table_slice;       // of the guard's texture, where the tables begin
  int tables[12];        // first entry of each level's
  ivec3 bricks;          // of the level, along each axis
  int table;             // tables[level]
};
