// What Python holds: what ivory reads and bakes, each with a name for messages. None changes after it is made, so that
// threads may share them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <pybind11/pybind11.h>

#include "grid/cubemap/reader.h"
#include "grid/env/irradiance/tree.h"
#include "grid/field/irradiance_grid.h"
#include "grid/fiv/table.h"
#include "grid/io/lobes.h"
#include "grid/io/sh9.h"
#include "grid/lobes/sphere_set.h"
#include "tools/bake/facts.h"

namespace ivory::python {

struct SceneAsset {
  std::string path;
  SceneInput input;
};

struct EnvironmentAsset {
  EnvironmentChoice choice;
  EnvironmentInput input;
  IrradianceTree tree;
};

// Where a picture is taken from, in the world, metres.
struct CameraAsset {
  V3d position;
  V3d target;
  V3d up;
  double fov_deg = 0;  // vertical
};

// Assets that are plain data.
template <typename Data>
struct Asset {
  std::string name;  // the file that it was read from, or what it was baked from
  Data data;
  std::vector<std::string> warnings = {};
};
using GridAsset = Asset<IrradianceGrid>;
struct Sh9Read {
  ivory::Sh9Asset asset;
  Sh9MatricesF matrices;
};
using Sh9 = Asset<Sh9Read>;
using DifMapAsset = Asset<DifMap>;
using FivAsset = Asset<FivTable>;
using CubeMapAsset = Asset<LocalizedCube>;
using LobesAsset = Asset<LobesFile>;
using SpheresAsset = Asset<SphereSet>;

// The classes, all declared before any has a method, so that signatures can name each other.
struct Classes {
  explicit Classes(pybind11::module_& m);
  pybind11::class_<SceneAsset> scene;
  pybind11::class_<MeshInput> mesh;
  pybind11::class_<CameraAsset> camera;
  pybind11::class_<EnvironmentAsset> environment;
  pybind11::class_<GridAsset> grid;
  pybind11::class_<Sh9> sh9;
  pybind11::class_<DifMapAsset> difmap;
  pybind11::class_<FivAsset> fiv;
  pybind11::class_<CubeMapAsset> cubemap;
  pybind11::class_<LobesAsset> lobes;
  pybind11::class_<SpheresAsset> spheres;
};

// A file each.
void bind_scene(Classes& classes);
void bind_render(Classes& classes, pybind11::module_& m);
void bind_grid(Classes& classes);
void bind_grid_bake(Classes& classes);
void bind_environment(Classes& classes);
void bind_cubemap(Classes& classes);
void bind_fiv(Classes& classes);
void bind_lobes(Classes& classes, pybind11::module_& m);

Sh9 make_sh9(std::string name, ivory::Sh9Asset asset);
EnvironmentAsset load_environment_asset(const std::string& path, const std::string& layout);

// Throws ParameterError for a value out of range.
inline void require(bool holds, const char* parameter, const char* cause) {
  if (!holds) throw ParameterError(parameter, cause);
}

// A parameter that takes an enum's names; its own name comes first in what is thrown, not the enum's.
template <typename Enum>
Enum choice(const char* parameter, const std::string& name) {
  try {
    return from_name<Enum>(name);
  } catch (const ParameterError& error) {
    throw ParameterError(parameter, error.cause());
  }
}

// How a grid is read: guard, interpolation, reconstruction, and for points nudge (in voxels).
struct LookupNames {
  std::optional<std::string> guard;  // none: the best there is
  std::string interpolation = "trilinear";
  std::string reconstruction = "optimal";
  float nudge_voxels = LookupParams{}.nudge_voxels;
};
// Guard::rays is the default where a scene is at hand. Throws where the grid cannot be read so.
LookupParams lookup_params(const GridAsset& grid, bool has_scene, const LookupNames& names);

// Throws Error where the grid is no indirect light of that scene as it is lit; the line that warns of one baked from
// another scene.
std::vector<std::string> check_grid_of(const GridAsset& grid, const SceneAsset& scene);
// The grid with its positions counted as the scene's are: itself, or a copy in `moved`.
const IrradianceGrid& grid_in_scene(const GridAsset& grid, const SceneAsset& scene,
                                    std::optional<IrradianceGrid>& moved);

}  // namespace ivory::python
