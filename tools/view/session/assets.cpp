#include "tools/view/session/assets.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "grid/base/error.h"
#include "grid/io/cubemap.h"
#include "grid/io/difmap.h"
#include "grid/io/fiv.h"
#include "grid/io/sh9.h"
#include "grid/io/sphere_set.h"
#include "tools/input/environment.h"
#include "tools/input/vdb/load.h"

namespace ivory {

namespace {

std::string text_of(const Metadata& metadata, const char* key) { return find_text(metadata, key).value_or(""); }

float luminance_vector_length(const float* components) {  // [xyz][rgb]
  V3f v;
  for (unsigned c = 0; c < 3; ++c) v[c] = luminance({components[3 * c], components[3 * c + 1], components[3 * c + 2]});
  return v.length();
}

// First guesses need no more than some 100,000 of the vertices. Odd, so that all places within bricks have their turn.
std::size_t guess_stride(const IrradianceGrid& grid) {
  constexpr std::size_t enough = 100'000;
  return grid.vertex_count() / enough | 1U;
}

float typical_vector(const IrradianceGrid& grid) {
  if (grid.basis != Basis::vectors) return 0;
  std::vector<float> lengths;
  for (std::size_t v = 0; v < grid.vertex_count(); v += guess_stride(grid)) {
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
  for (std::size_t v = 0; v < grid.vertex_count(); v += guess_stride(grid)) {
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

GridAsset make_grid_asset(const std::string& path, const IrradianceGrid& grid) {
  GridAsset asset;
  asset.gpu = upload(grid, {}, path);
  const GridAtlas& atlas = asset.gpu.atlas;
  const auto texel_index = [](const V3i& at, const V3i& size) {
    return (std::size_t(at.z) * std::size_t(size.y) + std::size_t(at.y)) * std::size_t(size.x) + std::size_t(at.x);
  };
  const V3i bricks = atlas.size / brick_side;
  std::vector<float> seen(texel_index(V3i(0, 0, atlas.size.z), atlas.size));
  // Where each brick of the atlas stands: its coordinates in its level, and the level plus one; 0 for none.
  std::vector<std::array<std::uint32_t, 4>> places(grid.levels() > 1 ? texel_index(V3i(0, 0, bricks.z), bricks) : 0);
  for (std::uint32_t v = 0; v < grid.vertex_count(); ++v) {
    const V3i texel = atlas.texel_of(grid, v);
    seen[texel_index(texel, atlas.size)] = grid.visible_fraction[v];
    if (places.empty()) continue;
    const VertexPlace place = grid.place_of(v);
    const V3i brick = place.at / brick_side;
    places[texel_index(texel / brick_side, bricks)] = {std::uint32_t(brick.x), std::uint32_t(brick.y),
                                                       std::uint32_t(brick.z), std::uint32_t(place.level + 1)};
  }
  asset.visible_fraction = gl::make_texture_3d(path, gl::Format::r16f, atlas.size, seen.data(), gl::Filter::nearest);
  if (!places.empty()) {
    asset.brick_places = gl::make_texture_3d(path, gl::Format::rgba32ui, bricks, places.data(), gl::Filter::nearest);
  }
  asset.typical_vector_lux = typical_vector(grid);
  asset.mean_e_lux = mean_irradiance(grid);
  asset.direct = direct_sources(grid.light);
  return asset;
}

std::unique_ptr<ViewAsset> make_asset(const std::string& path, AssetData data, std::string environment_hash = {},
                                      Metadata metadata = {}) {
  auto asset =
      std::make_unique<ViewAsset>(ViewAsset{path, std::move(data), std::move(environment_hash), std::move(metadata)});
  asset->environment_turn_deg = environment_turn_deg(asset->metadata);
  return asset;
}

}  // namespace

FileKind ViewAsset::kind() const {
  constexpr std::array<FileKind, std::variant_size_v<AssetData>> kinds{
      FileKind::grid,    FileKind::sh9,   FileKind::difmap, FileKind::fiv,
      FileKind::cubemap, FileKind::lobes, FileKind::spheres};
  return kinds[data.index()];
}

std::string ViewAsset::label() const { return std::filesystem::path(path).filename().string(); }

std::size_t ViewAsset::bytes() const {
  struct Bytes {
    std::size_t operator()(const GridAsset& grid) const {
      return grid.gpu.bytes() + grid.visible_fraction.bytes() + grid.brick_places.bytes();
    }
    std::size_t operator()(const DifMapAsset& map) const { return map.gpu.bytes(); }
    std::size_t operator()(const GpuSh9& sh) const { return sh.bytes(); }
    std::size_t operator()(const GpuLocalizedCube& cube) const { return cube.bytes(); }
    std::size_t operator()(const GpuLobes& lobes) const { return lobes.bytes(); }
    std::size_t operator()(const FivSet&) const { return 0; }
    std::size_t operator()(const SphereSetAsset&) const { return 0; }
  };
  return std::visit(Bytes{}, data);
}

std::unique_ptr<ViewAsset> load_view_asset(const std::string& path, FileKind kind, const V3d& anchor_m) {
  switch (kind) {
    case FileKind::grid: {
      IrradianceGrid grid = load_grid_or_sums_vdb(path, /*with_groups=*/true);
      set_anchor(grid, anchor_m);
      GridAsset asset = make_grid_asset(path, grid);
      Metadata metadata = grid.metadata;
      if (!grid.groups.empty()) asset.grouped = std::make_shared<const IrradianceGrid>(std::move(grid));
      return make_asset(path, std::move(asset), {}, std::move(metadata));
    }
    case FileKind::sh9: {
      const Sh9Asset sh9 = read_sh9(path);
      auto asset = make_asset(path, upload(sh9.sh), text_of(sh9.metadata, "environment_hash"));
      asset->environment_turn_deg = environment_turn_deg(sh9.metadata);
      return asset;
    }
    case FileKind::difmap:
      return make_view_difmap(path, read_difmap(path));
    case FileKind::cubemap: {
      LocalizedCube cube = read_localized_cube(path);
      set_anchor(cube, anchor_m);
      return make_asset(path, upload(cube, path), {}, cube.metadata);
    }
    case FileKind::fiv: {
      FivSet set = read_fiv_set(path);
      const Metadata& metadata = set.turns.front().metadata;
      std::string hash = text_of(metadata, "environment_hash");
      const double turn_deg = environment_turn_deg(metadata);
      auto asset = make_asset(path, std::move(set), std::move(hash));
      asset->environment_turn_deg = turn_deg;
      return asset;
    }
    case FileKind::lobes:
      return make_asset(path, load_lobes(path));
    case FileKind::spheres:
      return make_asset(path, SphereSetAsset{read_spheres(path)});
    case FileKind::scene:
    case FileKind::image:
      break;
  }
  throw Error(path, "is no asset that lights a scene", "give a grid, SH9, DifMap, FIV table, cube map or lobes");
}

void mix_asset(ViewAsset& asset, const GroupFactors& factors) {
  auto* grid = std::get_if<GridAsset>(&asset.data);
  if (grid == nullptr || !grid->grouped) return;
  std::shared_ptr<const IrradianceGrid> grouped = grid->grouped;
  *grid = make_grid_asset(asset.path, mix_groups(*grouped, factors));
  grid->grouped = std::move(grouped);
}

std::unique_ptr<ViewAsset> make_view_grid(const std::string& path, const IrradianceGrid& grid) {
  std::unique_ptr<ViewAsset> asset = make_asset(path, make_grid_asset(path, grid), {}, grid.metadata);
  asset->given = false;
  return asset;
}

std::unique_ptr<ViewAsset> make_view_difmap(const std::string& path, const DifMap& map) {
  auto asset = make_asset(path, DifMapAsset{upload(map, {}, path), mean_irradiance(map)},
                          text_of(map.metadata, "environment_hash"));
  asset->environment_turn_deg = environment_turn_deg(map.metadata);
  return asset;
}

std::unique_ptr<ViewAsset> make_view_lobes() {
  std::unique_ptr<ViewAsset> asset = make_asset("lobe table made at start", upload(make_lobe_table()));
  asset->given = false;
  return asset;
}

const ViewAsset* find_asset(const ViewAssets& assets, FileKind kind) {
  for (const auto& asset : assets) {
    if (asset->kind() == kind) return asset.get();
  }
  return nullptr;
}

}  // namespace ivory
