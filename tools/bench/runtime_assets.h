// What ivory bench runtime draws with: an object under an environment and every asset of it, baked in memory.
#pragma once

#include <vector>

#include "grid/cubemap/localized.h"
#include "grid/env/difmap.h"
#include "grid/field/irradiance_grid.h"
#include "grid/fiv/table.h"
#include "grid/lobes/sphere_set.h"
#include "grid/lobes/table.h"
#include "tracer/bake/fiv/occluder.h"
#include "tracer/core/scene.h"

namespace ivory {

// A square floor of half side `half_side_m` about the origin, facing up.
Mesh make_floor(float half_side_m);

struct RuntimeBenchAssets {
  FivOccluder occluder;  // the object
  std::size_t triangles = 0;
  CubeMap environment;  // 32 texels a side
  Sh9 sh9;
  DifMap difmap;
  FivTable table;         // 64 x 33 x 30 samples, six hemispheres
  IrradianceGrid grid;    // of the object on a floor of 8 x 8 m under the environment, with its guard
  IrradianceGrid levels;  // the same in three spacings, of which the finest is the grid's
  LocalizedCube cube;     // 4 texels a side
  LobeTable lobes;
  SphereSet spheres;
};
RuntimeBenchAssets make_runtime_bench_assets(const Scene& object, const EnvironmentMap& environment, int grid_side);

// The same table read at the samples of another size: values that cost what baked ones do.
FivTable resampled(const FivTable& table, const V3i& size);

// The same object in more triangles: each split into four, `times` over.
Scene subdivided(Scene scene, int times);
std::size_t triangle_count(const Scene& scene);

// `count` copies strewn over the floor, feet on the ground.
std::vector<V3f> strewn_on_floor(int count, float half_side_m);

}  // namespace ivory
