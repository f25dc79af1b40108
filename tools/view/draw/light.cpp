// Which asset lights an object by which method, and what of it moves.
#include <utility>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/view/draw/debug.h"
#include "tools/view/session.h"

namespace ivory {

namespace {

// The first asset that the method reads.
const ViewAsset* asset_for(const ViewSession& session, ViewMethod method) {
  switch (method) {
    case ViewMethod::grid:
      return find_asset(session.assets, FileKind::grid);
    case ViewMethod::cubemap:
      return find_asset(session.assets, FileKind::cubemap);
    case ViewMethod::lobes:
      return find_asset(session.assets, FileKind::lobes);
    case ViewMethod::sh9:
      return find_asset(session.assets, FileKind::sh9);
    case ViewMethod::difmap:
      return find_asset(session.assets, FileKind::difmap);
    case ViewMethod::fiv: {
      // What the environment gives where nothing hides it; SH9 is the second choice.
      const ViewAsset* difmap = find_asset(session.assets, FileKind::difmap);
      return difmap != nullptr ? difmap : find_asset(session.assets, FileKind::sh9);
    }
    default:
      return nullptr;
  }
}

}  // namespace

std::string lacks(const ViewSession& session, ViewMethod method) {
  if (method == ViewMethod::lobes && session.world.scene().sphere_lights.empty())
    return "the scene has no spherical light (--sphere-light)";
  if (method == ViewMethod::none || method == ViewMethod::constant) return "";
  const ViewAsset* asset = asset_for(session, method);
  if (asset == nullptr) return fmt::format("no asset that method {} reads was given", name_of(method));
  if (asset->grid && session.settings.lookup.reconstruction == Reconstruction::paper &&
      asset->grid->gpu.basis != Basis::vectors)
    return fmt::format("--reconstruction paper needs a grid of basis vectors, {} has {}", asset->path,
                       name_of(asset->grid->gpu.basis));
  if (method == ViewMethod::fiv && !session.occluders.gpu) return "no FIV table was given";
  return "";
}

std::string lacks(const ViewSession& session, DebugView view) {
  if (needs_grid(view) && session.debug_grid == nullptr) return "it shows a grid, and none was given";
  if (view == DebugView::difference && !session.reference) return "it needs a --reference";
  const bool by_guard = view == DebugView::kept || view == DebugView::guard;
  if (by_guard && !session.debug_grid->grid->gpu.guarded) return "it needs a grid with a leak guard";
  const bool six = view == DebugView::vectors || view == DebugView::bracket;
  if (six && session.debug_grid->grid->gpu.basis != Basis::vectors)
    return fmt::format("it needs a grid of basis vectors, {} has {}", session.debug_grid->label(),
                       name_of(session.debug_grid->grid->gpu.basis));
  return "";
}

void choose_method(ViewSession& session, std::size_t object, ViewMethod method) {
  if (const std::string lack = lacks(session, method); !lack.empty()) throw UsageError(lack);
  session.lights[object] = {method, asset_for(session, method)};
}

namespace {

// A set that was fitted to an object's file goes where the object goes.
V3f place_of_spheres(const ViewSession& session, const ViewAsset& asset) {
  const auto hash = find_text(asset.spheres->metadata, "mesh_hash");
  if (!hash) return asset.offset_m;
  for (const ViewObject& object : session.world.objects) {
    if (object.moves && *hash == object.scene->content_hash)
      return asset.offset_m + place(object, session.world.time_s);
  }
  return asset.offset_m;
}

// Groups of spheres take longer to build than a point of each pixel to draw: only when one of them moved.
void place_lobes(ViewSession& session) {
  std::vector<std::pair<const ViewAsset*, V3f>> places;
  for (const auto& asset : session.assets) {
    if (asset->spheres || asset->lobes)
      places.emplace_back(asset.get(), asset->spheres ? place_of_spheres(session, *asset) : V3f(0, 0, 0));
  }
  if (places == session.lobes_placed) return;
  std::vector<BallLight> lights;
  for (const SphereLight& light : session.world.scene().sphere_lights)
    lights.push_back({{light.center, light.radius_m}, light.radiance_nits});
  std::vector<Sphere> occluders;
  for (const auto& [asset, offset] : places) {
    if (!asset->spheres) continue;
    for (const Sphere& sphere : asset->spheres->spheres) occluders.push_back({sphere.center + offset, sphere.radius_m});
  }
  for (const auto& asset : session.assets) {
    if (asset->lobes) place(*asset->lobes, lights, occluders);
  }
  session.lobes_placed = std::move(places);
}

}  // namespace

void place_objects_now(ViewSession& session) {
  place_occluders(session.occluders, session.world);
  place_lobes(session);
}

AmbientSource grid_source(const ViewAsset& asset, const ViewSettings& settings) {
  return ambient(asset.grid->gpu, {settings.lookup, settings.guard});
}

AmbientSource ambient_source(const ViewSession& session, std::size_t object) {
  const ObjectLight& light = session.lights[object];
  const ViewSettings& settings = session.settings;
  switch (light.method) {
    case ViewMethod::constant:
      return constant_ambient(settings.constant_e_lux);
    case ViewMethod::grid:
      return grid_source(*light.asset, settings);
    case ViewMethod::cubemap:
      return ambient(*light.asset->cubemap, settings.cube_method);
    case ViewMethod::lobes:
      // What debug views show as irradiance is that of a Lambert surface.
      return ambient(*light.asset->lobes, surface_debug_shader(settings.debug).empty(), settings.lobes);
    case ViewMethod::sh9:
      return ambient(*light.asset->sh9);
    case ViewMethod::difmap:
      return ambient(*light.asset->difmap);
    case ViewMethod::fiv: {
      const GpuFivTables& tables = *session.occluders.gpu;
      const int self = session.occluders.of_object[object];
      return light.asset->difmap ? ambient(tables, *light.asset->difmap, settings.fiv, self)
                                 : ambient(tables, *light.asset->sh9, settings.fiv, self);
    }
    default:
      return no_ambient();
  }
}

}  // namespace ivory
