// The baked assets that the viewer offers to light by, on the GPU.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "grid/field/mix.h"
#include "grid/fiv/set.h"
#include "grid/lobes/sphere_set.h"
#include "runtime/assets/cubemap.h"
#include "runtime/assets/difmap.h"
#include "runtime/assets/irradiance_grid.h"
#include "runtime/assets/lobes.h"
#include "runtime/assets/sh9.h"
#include "tools/input/file_kind.h"

namespace ivory {

struct GridAsset {
  GpuGrid gpu;
  gl::Texture visible_fraction;  // R16F, a texel a vertex: the runtime keeps a capped form of it only
  gl::Texture brick_places;  // of several levels: RGBA32UI, where each of the atlas' bricks stands (draw/overlay.cpp)
  float typical_vector_lux = 0;  // length that nineteen in twenty of the stored vectors stay under
  Rgb mean_e_lux{0, 0, 0};       // about
  DirectSources direct;          // whose light it holds as it comes straight from them
  // Of a grid that keeps groups of lights apart: to mix it again. Null for others.
  std::shared_ptr<const IrradianceGrid> grouped;
};

struct DifMapAsset {
  GpuDifMap gpu;
  Rgb mean_e_lux{0, 0, 0};
};

// It casts shadows by method lobes.
struct SphereSetAsset {
  SphereSet set;
  V3d offset_m{0, 0, 0};  // from where its file has it
};

// FIV tables wait on the CPU: on the GPU all of them are one texture (tools/view/session/occluders.h).
using AssetData = std::variant<GridAsset, GpuSh9, DifMapAsset, FivSet, GpuLocalizedCube, GpuLobes, SphereSetAsset>;

struct ViewAsset {
  std::string path;
  AssetData data;
  std::string environment_hash;     // of the environment that it was baked from; empty: of none
  Metadata metadata;                // of grids and localized cube maps
  bool given = true;                // by the user; false: made of what was given
  double environment_turn_deg = 0;  // that its environment had when it was baked

  FileKind kind() const;
  std::string label() const;  // the path without folders
  std::size_t bytes() const;  // on the GPU
};

// Sources of light refer to assets: they stay where they are.
using ViewAssets = std::vector<std::unique_ptr<ViewAsset>>;

// All need a current context and throw Error as upload() does.

// Reads and uploads, for a scene of that anchor. Throws Error as the kind's reader does too, and for a kind that lights
// no scene.
std::unique_ptr<ViewAsset> load_view_asset(const std::string& path, FileKind kind, const V3d& anchor_m);

// A grid that keeps groups apart, lit by them as they are now; nothing for other assets. Throws ParameterError as
// mix_groups() does.
void mix_asset(ViewAsset& asset, const GroupFactors& factors);

// Of a grid made in memory, for a scene of its anchor; `path` names it.
std::unique_ptr<ViewAsset> make_view_grid(const std::string& path, const IrradianceGrid& grid);

// Of a map made in memory; `path` names it.
std::unique_ptr<ViewAsset> make_view_difmap(const std::string& path, const DifMap& map);

// Makes the table of lobes: a second's work.
std::unique_ptr<ViewAsset> make_view_lobes();

// The first asset of that kind; null for none.
const ViewAsset* find_asset(const ViewAssets& assets, FileKind kind);

}  // namespace ivory
