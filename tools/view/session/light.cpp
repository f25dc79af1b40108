#include "tools/view/session/light.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "tools/cli/numbers.h"
#include "tools/view/draw/debug.h"
#include "tools/view/session/occluders.h"

namespace ivory {

namespace {

// Of all assets of that kind number `nth`, from 0.
const ViewAsset* nth_asset(const ViewAssets& assets, FileKind kind, std::size_t nth) {
  for (const auto& asset : assets) {
    if (asset->kind() == kind && nth-- == 0) return asset.get();
  }
  return nullptr;
}

// The asset that the method reads: the first, or a later one for who reads others already.
const ViewAsset* asset_for(const ViewSession& session, ViewMethod method, std::size_t nth = 0) {
  switch (method) {
    case ViewMethod::grid:
      return nth_asset(session.assets, FileKind::grid, nth);
    case ViewMethod::cubemap:
      return nth_asset(session.assets, FileKind::cubemap, nth);
    case ViewMethod::lobes:
      return nth_asset(session.assets, FileKind::lobes, nth);
    case ViewMethod::sh9:
      return nth_asset(session.assets, FileKind::sh9, nth);
    case ViewMethod::difmap:
      return nth_asset(session.assets, FileKind::difmap, nth);
    case ViewMethod::fiv: {
      // What the environment gives where nothing hides it; SH9 is the second choice.
      const ViewAsset* difmap = nth_asset(session.assets, FileKind::difmap, nth);
      return difmap != nullptr ? difmap : nth_asset(session.assets, FileKind::sh9, nth);
    }
    default:
      return nullptr;
  }
}

// Where its spheres stand. A set that was fitted to an object's file goes where the object goes.
Placement place_of_spheres(const ViewSession& session, const SphereSetAsset& spheres) {
  const auto hash = spheres.set.metadata.find("mesh_hash");
  const V3d from = spheres.set.anchor_m + spheres.offset_m;
  const V3f unmoved = to_local(from, session.world.scene().anchor_m);
  if (hash == spheres.set.metadata.end()) return {unmoved};
  for (const ViewObject& object : session.world.objects) {
    if (object.moves && hash->second == MetaValue(object.scene->content_hash)) {
      // The object's pivot, as the set's file has it.
      const V3f in_object = to_local(from, object.scene->anchor_m);
      Placement at = place(object, session.world.time_s);
      at.pivot_m -= in_object;
      at.offset_m += in_object;
      return at;
    }
  }
  return {unmoved};
}

// Groups of spheres take longer to build than a point of each pixel to draw: only when one of them moved.
void place_lobes(ViewSession& session) {
  std::vector<std::pair<const ViewAsset*, Placement>> places;
  for (const auto& asset : session.assets) {
    if (const auto* spheres = std::get_if<SphereSetAsset>(&asset->data)) {
      places.emplace_back(asset.get(), place_of_spheres(session, *spheres));
    } else if (std::holds_alternative<GpuLobes>(asset->data)) {
      places.emplace_back(asset.get(), Placement{});
    }
  }
  if (places == session.lobes_placed) return;
  std::vector<RuntimeSphereLight> lights;
  for (const SphereLight& light : session.world.scene().sphere_lights)
    lights.push_back({{light.center, light.radius_m}, light.radiance_nits});
  std::vector<Sphere> occluders;
  for (const auto& [asset, at] : places) {
    const auto* spheres = std::get_if<SphereSetAsset>(&asset->data);
    if (spheres == nullptr) continue;
    for (const Sphere& sphere : spheres->set.spheres)
      occluders.push_back({placed(at, sphere.center), sphere.radius_m * at.scale});
  }
  for (const auto& asset : session.assets) {
    if (auto* lobes = std::get_if<GpuLobes>(&asset->data)) place(*lobes, lights, occluders);
  }
  session.lobes_placed = std::move(places);
}

}  // namespace

namespace {

std::string lacks(const ViewSession& session, ViewMethod method, std::size_t nth) {
  if (method == ViewMethod::lobes && session.world.scene().sphere_lights.empty())
    return "the scene has no spherical light (--sphere-light)";
  if (method == ViewMethod::none || method == ViewMethod::constant) return "";
  const ViewAsset* asset = asset_for(session, method, nth);
  if (asset == nullptr) {
    return nth == 0 ? fmt::format("no asset that method {} reads was given", name_of(method))
                    : fmt::format("{} assets for method {} are named, and {} given", nth + 1, name_of(method), nth);
  }
  if (const auto* grid = std::get_if<GridAsset>(&asset->data);
      grid != nullptr && !reads(session.settings.lookup.reconstruction, grid->gpu.basis)) {
    return fmt::format("--reconstruction paper needs a grid of basis vectors, {} has {}", asset->path,
                       name_of(grid->gpu.basis));
  }
  if (method == ViewMethod::fiv && !session.fiv_tables) return "no FIV table was given";
  return "";
}

// How many of the first `count` sources have that method.
std::size_t of_method(std::span<const ObjectLight> lights, ViewMethod method) {
  return std::size_t(
      std::count_if(lights.begin(), lights.end(), [&](const ObjectLight& l) { return l.method == method; }));
}

ObjectLight light_by(const ViewSession& session, ViewMethod method, std::span<const ObjectLight> before, float weight) {
  const std::size_t nth = of_method(before, method);
  if (const std::string lack = lacks(session, method, nth); !lack.empty()) throw ParameterError("method", lack);
  return {method, asset_for(session, method, nth), weight};
}

}  // namespace

std::string lacks(const ViewSession& session, ViewMethod method) { return lacks(session, method, 0); }

std::string lacks(const ViewSession& session, DebugView view) {
  if (view == DebugView::difference && !session.reference) return "it needs a --reference";
  if (!needs_grid(view)) return "";
  if (session.debug_grid == nullptr) return "it shows a grid, and none was given";
  const GpuGrid& grid = std::get<GridAsset>(session.debug_grid->data).gpu;
  const bool by_guard = view == DebugView::kept || view == DebugView::guard;
  if (by_guard && !grid.guarded) return "it needs a grid with a leak guard";
  const bool six = view == DebugView::vectors || view == DebugView::bracket;
  if (six && grid.basis != Basis::vectors)
    return fmt::format("it needs a grid of basis vectors, {} has {}", session.debug_grid->label(), name_of(grid.basis));
  return "";
}

void choose_method(ViewSession& session, std::size_t object, ViewMethod method) {
  session.world.objects[object].lights = {light_by(session, method, {}, 1)};
}

void choose_method(ViewSession& session, std::size_t object, std::size_t part, ViewMethod method) {
  std::vector<ObjectLight>& lights = session.world.objects[object].lights;
  lights[part] = light_by(session, method, std::span(lights).first(part), lights[part].weight);
}

void choose_lights(ViewSession& session, std::size_t object, std::string_view text) {
  std::vector<ObjectLight> lights;
  std::string_view rest = text;
  while (true) {
    const std::string_view part = rest.substr(0, rest.find('+'));
    const std::size_t star = part.find('*');
    float weight = 1;
    if (star != std::string_view::npos) {
      const std::optional<double> number = parse_number(part.substr(star + 1));
      if (!number || !(*number >= 0)) {
        throw ParameterError("method", fmt::format("'{}' is no source with a weight: METHOD*WEIGHT", part));
      }
      weight = float(*number);
    }
    lights.push_back(light_by(session, view_method_from_name(part.substr(0, star)), lights, weight));
    if (part.size() == rest.size()) break;
    rest.remove_prefix(part.size() + 1);
  }
  session.world.objects[object].lights = std::move(lights);
}

std::string lights_text(const ViewObject& object) {
  std::string text;
  for (const ObjectLight& light : object.lights) {
    text += fmt::format("{}{}", text.empty() ? "" : "+", name_of(light.method));
    if (light.weight != 1) text += fmt::format("*{}", light.weight);
  }
  return text;
}

HeldLight held_light(const ViewSession& session, const ViewObject& object) {
  HeldLight held;
  for (const ObjectLight& light : object.lights) {
    switch (light.method) {
      case ViewMethod::grid: {
        const DirectSources direct = std::get<GridAsset>(light.asset->data).direct;
        held.punctual = held.punctual || direct.punctual;
        held.surfaces = held.surfaces || direct.area;
        held.spheres = held.spheres || direct.area;
        held.environment = held.environment || direct.sky;
        break;
      }
      case ViewMethod::cubemap:
        // It holds whatever it saw from where it was captured, but no light without extent.
        held.surfaces = held.spheres = held.environment = true;
        break;
      case ViewMethod::lobes:
        held.spheres = true;
        break;
      case ViewMethod::sh9:
      case ViewMethod::difmap:
      case ViewMethod::fiv:
        held.environment = held.environment || !session.environment.empty();
        break;
      default:
        break;
    }
  }
  return held;
}

namespace {

// What assets hold of the environment goes round with it, but for what is spread over places.
void turn_environments(ViewSession& session) {
  for (const auto& asset : session.assets) {
    const double turn_deg = session.environment_turn_deg - asset->environment_turn_deg;
    const auto turn_rad = float(std::remainder(turn_deg, 360.0) * radians_a_degree);
    if (auto* map = std::get_if<DifMapAsset>(&asset->data)) map->gpu.turn_rad = turn_rad;
    if (auto* sh9 = std::get_if<GpuSh9>(&asset->data)) sh9->turn_rad = turn_rad;
    const bool stays = asset->kind() == FileKind::grid || asset->kind() == FileKind::cubemap;
    if (!stays || turn_rad == 0 || session.told_of_old_sky || !find_text(asset->metadata, "environment_hash")) continue;
    session.told_of_old_sky = true;
    session.notes.push_back(
        fmt::format("note: {} keeps the light of the environment as it stood when it was baked, at --env-turn {}; bake "
                    "it again for another",
                    asset->label(), asset->environment_turn_deg));
  }
}

}  // namespace

void place_lights_and_occluders(ViewSession& session) {
  turn_environments(session);
  if (session.fiv_tables) {
    std::vector<bool> before;
    for (const ViewObject& object : session.world.objects) before.push_back(object.occludes);
    const double then = find_asset(session.assets, FileKind::fiv)->environment_turn_deg;
    place_occluders(*session.fiv_tables, session.world, session.environment_turn_deg - then);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const ViewObject& object = session.world.objects[i];
      if (before[i] && !object.occludes)
        session.notes.push_back("note: " + why_it_hides_nothing(object, session.world.time_s));
    }
  }
  place_lobes(session);
}

void require_turns(const ViewSession& session) {
  bool by_fiv = false;
  for (const ViewObject& object : session.world.objects)
    by_fiv = by_fiv || of_method(object.lights, ViewMethod::fiv) > 0;
  for (const ViewObject& object : session.world.objects) {
    if (by_fiv && !object.occludes) throw ParameterError("method", why_it_hides_nothing(object, session.world.time_s));
  }
}

AmbientSource grid_source(const ViewAsset& asset, const ViewSettings& settings) {
  return ambient(std::get<GridAsset>(asset.data).gpu, settings.lookup);
}

namespace {

AmbientSource source_of(const ViewSession& session, std::size_t object, const ObjectLight& light) {
  const ViewSettings& settings = session.settings;
  switch (light.method) {
    case ViewMethod::constant:
      return constant_ambient(settings.constant_e_lux);
    case ViewMethod::grid:
      return grid_source(*light.asset, settings);
    case ViewMethod::cubemap:
      return ambient(std::get<GpuLocalizedCube>(light.asset->data), settings.cube_method);
    case ViewMethod::lobes:
      // What debug views show as irradiance is that of a Lambert surface.
      return ambient(std::get<GpuLobes>(light.asset->data), surface_debug_shader(settings.debug).empty(),
                     settings.lobes);
    case ViewMethod::sh9:
      return ambient(std::get<GpuSh9>(light.asset->data));
    case ViewMethod::difmap:
      return ambient(std::get<DifMapAsset>(light.asset->data).gpu);
    case ViewMethod::fiv: {
      const GpuFivTables& tables = *session.fiv_tables;
      const int self = occluder_index(session.world, object);
      if (const auto* map = std::get_if<DifMapAsset>(&light.asset->data))
        return ambient(tables, map->gpu, settings.fiv, self);
      return ambient(tables, std::get<GpuSh9>(light.asset->data), settings.fiv, self);
    }
    default:
      return no_ambient();
  }
}

}  // namespace

AmbientSource ambient_source(const ViewSession& session, std::size_t object) {
  std::vector<WeightedSource> sources;
  for (const ObjectLight& light : session.world.objects[object].lights)
    sources.push_back({source_of(session, object, light), Rgb(light.weight, light.weight, light.weight)});
  return sum_of(sources);
}

}  // namespace ivory
