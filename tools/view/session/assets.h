// The baked assets that the viewer offers to light by, on the GPU.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "grid/fiv/table.h"
#include "runtime/assets/cubemap.h"
#include "runtime/assets/difmap.h"
#include "runtime/assets/irradiance_grid.h"
#include "runtime/assets/lobes.h"
#include "runtime/assets/sh9.h"
#include "tools/cli/file_kind.h"

namespace ivory {

struct GridAsset {
  GpuGrid gpu;
  gl::Texture visible_fraction;  // R16F, a texel a vertex: the runtime keeps a capped form of it only
  float typical_vector_lux = 0;  // length that nineteen in twenty of the stored vectors stay under
  bool holds_direct = false;     // light as well as indirect
  std::string scene_hash;        // of the scene that it was baked from
};

struct ViewAsset {
  std::string path;
  FileKind kind = FileKind::grid;
  std::unique_ptr<GridAsset> grid;
  std::optional<GpuSh9> sh9;
  std::optional<GpuDifMap> difmap;
  std::optional<GpuLocalizedCube> cubemap;
  std::optional<FivTable> fiv;  // on the GPU all tables are one texture: see view_occluders.h
  std::unique_ptr<GpuLobes> lobes;
  std::optional<SphereSet> spheres;  // shadows of method lobes
  Rgb mean_e_lux{0, 0, 0};           // of grids and DifMaps, about
  V3f offset_m{0, 0, 0};             // of the sphere set
  std::string environment_hash;      // of the environment that it was baked from

  std::string label() const;  // without folders
  std::size_t bytes() const;
};

// Sources of light refer to assets: they stay where they are.
using ViewAssets = std::vector<std::unique_ptr<ViewAsset>>;

// The DifMap of an environment, made here and now.
std::unique_ptr<ViewAsset> bake_view_difmap(const std::string& path, const DifMap& map);

// A lobe table, made here and now: a second's work.
std::unique_ptr<ViewAsset> make_view_lobes();

// Reads and uploads. Throws Error as the kind's reader does, and where it cannot light a scene.
std::unique_ptr<ViewAsset> load_view_asset(const std::string& path, FileKind kind);

// The first asset of that kind; null for none.
const ViewAsset* find_asset(const ViewAssets& assets, FileKind kind);

}  // namespace ivory
