#include "tools/view/session/occluders.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "grid/base/error.h"
#include "tracer/bake/fiv/occluder.h"

namespace ivory {

namespace {

// Objects that are occluders, in the order that the GPU has them: by table, then as they come.
std::vector<std::size_t> occluding_objects(const ViewWorld& world) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    if (world.objects[i].occluder && world.objects[i].occludes) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return world.objects[a].occluder->table < world.objects[b].occluder->table;
  });
  return order;
}

// What each object is; tables count in the order of the assets.
std::vector<std::optional<GpuFivOccluder>> occluders_of(const ViewAssets& assets, const ViewWorld& world) {
  std::vector<std::optional<GpuFivOccluder>> found(world.objects.size());
  int table = -1;
  for (const auto& asset : assets) {
    const auto* set = std::get_if<FivSet>(&asset->data);
    if (set == nullptr) continue;
    ++table;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const ViewObject& object = world.objects[i];
      if (!object.moves || found[i]) continue;
      const std::vector<bool> all(object.scene->instances.size(), true);
      if (const auto placed = find_turned_placement(set->turns.front(), *object.scene, all))
        found[i] = GpuFivOccluder{table, placed->at.center_m, placed->at.radius_m, float(placed->turn_rad)};
    }
  }
  return found;
}

}  // namespace

void find_occluders_again(const ViewAssets& assets, ViewWorld& world) {
  if (find_asset(assets, FileKind::fiv) == nullptr) return;
  std::vector<std::optional<GpuFivOccluder>> found = occluders_of(assets, world);
  for (std::size_t i = 0; i < found.size(); ++i) world.objects[i].occluder = found[i];
}

std::optional<GpuFivTables> find_occluders(const ViewAssets& assets, ViewWorld& world) {
  std::vector<std::optional<GpuFivOccluder>> found = occluders_of(assets, world);
  std::vector<FivSet> sets;
  const ViewAsset* first = find_asset(assets, FileKind::fiv);
  for (const auto& asset : assets) {
    const auto* set = std::get_if<FivSet>(&asset->data);
    if (set == nullptr) continue;
    if (std::remainder(asset->environment_turn_deg - first->environment_turn_deg, 360.0) != 0) {
      throw Error(asset->path, "was baked with another --env-turn than " + first->label(),
                  "bake all tables of a picture with the same");
    }
    sets.push_back(*set);
  }
  if (sets.empty()) return std::nullopt;
  std::optional<GpuFivTables> gpu = upload(sets);
  const auto exchange = [&] {
    for (std::size_t i = 0; i < found.size(); ++i) std::swap(world.objects[i].occluder, found[i]);
  };
  exchange();
  try {
    place_occluders(*gpu, world, 0);
  } catch (...) {
    exchange();
    throw;
  }
  for (ViewObject& object : world.objects) object.occludes = true;  // until it is found not to, which is said
  return gpu;
}

void place_occluders(GpuFivTables& tables, ViewWorld& world, double environment_turn_deg) {
  const auto environment_turn_rad = float(std::remainder(environment_turn_deg, 360.0) * radians_a_degree);
  const auto standing = [&](const ViewObject& object) {
    const Placement at = place(object, world.time_s);
    GpuFivOccluder occluder = *object.occluder;
    occluder.center_m = placed(at, occluder.center_m);
    occluder.radius_m *= at.scale;
    occluder.turn_rad += at.turn_deg.y * (pi / 180);
    return occluder;
  };
  for (ViewObject& object : world.objects) {
    if (!object.occluder) continue;
    object.occludes = place(object, world.time_s).upright() && can_turn(tables, standing(object), environment_turn_rad);
  }
  std::vector<GpuFivOccluder> now;
  for (const std::size_t i : occluding_objects(world)) now.push_back(standing(world.objects[i]));
  set_occluders(tables, now, environment_turn_rad);
}

std::string why_it_hides_nothing(const ViewObject& object, double time_s) {
  if (!place(object, time_s).upright())
    return object.name + " is turned otherwise than about +Y, and FIV tables turn about +Y alone: it hides no light";
  return object.name +
         " is turned against the environment, and its FIV table holds one turn: it hides no light (ivory bake fiv "
         "--turns 24)";
}

int occluder_index(const ViewWorld& world, std::size_t object) {
  const std::vector<std::size_t> order = occluding_objects(world);
  const auto at = std::find(order.begin(), order.end(), object);
  return at == order.end() ? -1 : int(at - order.begin());
}

}  // namespace ivory
