#include "tools/view/draw/assets.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "grid/base/error.h"
#include "grid/io/difmap.h"
#include "grid/io/fiv.h"
#include "grid/io/sh9.h"
#include "grid/io/sphere_set.h"
#include "tools/cli/vdb_input.h"

namespace ivory {

namespace {

std::string text_of(const Metadata& metadata, const char* key) { return find_text(metadata, key).value_or(""); }

float luminance_vector_length(const float* components) {  // [xyz][rgb]
  V3f v;
  for (unsigned c = 0; c < 3; ++c) v[c] = luminance({components[3 * c], components[3 * c + 1], components[3 * c + 2]});
  return v.length();
}

float typical_vector(const IrradianceGrid& grid) {
  if (grid.basis != Basis::vectors) return 0;
  std::vector<float> lengths;
  for (std::size_t v = 0; v < grid.frame.vertex_count(); ++v) {
    if (grid.visible_fraction[v] <= 0) continue;
    const std::array<float, 54> vectors = hemispheres_from_moments(std::span<const float, 36>(grid.at(v), 36));
    for (std::size_t h = 0; h < 6; ++h) lengths.push_back(luminance_vector_length(vectors.data() + 9 * h));
  }
  if (lengths.empty()) return 0;
  const auto at = lengths.begin() + std::ptrdiff_t(lengths.size() * 19 / 20);
  std::nth_element(lengths.begin(), at, lengths.end());
  return *at;
}

// Along the axes' six normals, which is enough for a first guess.
Rgb mean_irradiance(const IrradianceGrid& grid) {
  V3d sum(0, 0, 0);
  double count = 0;
  for (std::size_t v = 0; v < grid.frame.vertex_count(); ++v) {
    if (grid.visible_fraction[v] <= 0) continue;
    for (unsigned axis = 0; axis < 6; ++axis) {
      V3f n(0, 0, 0);
      n[axis / 2] = axis % 2 == 0 ? 1.0F : -1.0F;
      const Rgb e = irradiance(grid.basis, Reconstruction::optimal, grid.at(v), n);
      sum += V3d(double(e.x), double(e.y), double(e.z));
      ++count;
    }
  }
  if (count > 0) sum /= count;
  return {float(sum.x), float(sum.y), float(sum.z)};
}

Rgb mean_irradiance(const DifMap& map) {
  V3d sum(0, 0, 0);
  for (const Rgb& e : map.e.texels) sum += V3d(double(e.x), double(e.y), double(e.z));
  sum /= double(map.e.texels.size());
  return {float(sum.x), float(sum.y), float(sum.z)};
}

std::unique_ptr<GridAsset> upload_grid_asset(const std::string& path, const IrradianceGrid& grid) {
  auto asset = std::make_unique<GridAsset>();
  // First, as it says which file is too large.
  asset->visible_fraction =
      gl::make_texture_3d(path, gl::Format::r16f, grid.frame.size, grid.visible_fraction.data(), gl::Filter::nearest);
  asset->gpu = upload(grid);
  asset->typical_vector_lux = typical_vector(grid);
  asset->holds_direct = grid.light != StoredLight::indirect;
  asset->scene_hash = text_of(grid.metadata, "scene_hash");
  return asset;
}

}  // namespace

std::string ViewAsset::label() const { return std::filesystem::path(path).filename().string(); }

std::size_t ViewAsset::bytes() const {
  std::size_t sum = 0;
  if (grid) sum += grid->gpu.bytes() + grid->visible_fraction.bytes();
  if (cubemap) sum += cubemap->bytes();
  if (lobes) sum += lobes->bytes();
  if (sh9) sum += sh9->bytes();
  if (difmap) sum += difmap->bytes();
  return sum;
}

std::unique_ptr<ViewAsset> load_view_asset(const std::string& path, FileKind kind) {
  auto asset = std::make_unique<ViewAsset>();
  asset->path = path;
  asset->kind = kind;
  switch (kind) {
    case FileKind::grid: {
      const IrradianceGrid grid = load_grid_vdb(path);
      asset->grid = upload_grid_asset(path, grid);
      asset->mean_e_lux = mean_irradiance(grid);
      break;
    }
    case FileKind::sh9: {
      const Sh9Asset sh9 = read_sh9(path);
      asset->sh9 = upload(sh9.sh);
      asset->environment_hash = text_of(sh9.metadata, "environment_hash");
      break;
    }
    case FileKind::difmap: {
      const DifMap map = read_difmap(path);
      asset->difmap = upload(map);
      asset->mean_e_lux = mean_irradiance(map);
      asset->environment_hash = text_of(map.metadata, "environment_hash");
      break;
    }
    case FileKind::cubemap:
      asset->cubemap = load_localized_cube(path);
      break;
    case FileKind::fiv:
      asset->fiv = read_fiv(path);
      asset->environment_hash = text_of(asset->fiv->metadata, "environment_hash");
      break;
    case FileKind::lobes:
      asset->lobes = std::make_unique<GpuLobes>(load_lobes(path));
      break;
    case FileKind::spheres:
      asset->spheres = read_spheres(path);
      break;
    case FileKind::scene:
    case FileKind::image:
      throw Error(path, "is no asset that lights a scene", "give a grid, SH9, DifMap, FIV table, cube map or lobes");
  }
  return asset;
}

std::unique_ptr<ViewAsset> make_view_lobes() {
  auto asset = std::make_unique<ViewAsset>();
  asset->path = "lobe table made at start";
  asset->kind = FileKind::lobes;
  asset->lobes = std::make_unique<GpuLobes>(upload(make_lobe_table()));
  return asset;
}

std::unique_ptr<ViewAsset> bake_view_difmap(const std::string& path, const DifMap& map) {
  auto asset = std::make_unique<ViewAsset>();
  asset->path = path;
  asset->kind = FileKind::difmap;
  asset->difmap = upload(map);
  asset->mean_e_lux = mean_irradiance(map);
  asset->environment_hash = text_of(map.metadata, "environment_hash");
  return asset;
}

const ViewAsset* find_asset(const ViewAssets& assets, FileKind kind) {
  for (const auto& asset : assets) {
    if (asset->kind == kind) return asset.get();
  }
  return nullptr;
}

}  // namespace ivory
