#include "tools/view/session/occluders.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "tracer/bake/fiv/occluder.h"

namespace ivory {

namespace {

// Objects that are occluders, in the order that the GPU has them: by table, then as they come.
std::vector<std::size_t> occluding_objects(const ViewWorld& world) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    if (world.objects[i].occluder) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return world.objects[a].occluder->table < world.objects[b].occluder->table;
  });
  return order;
}

}  // namespace

std::optional<GpuFivTables> find_occluders(const ViewAssets& assets, ViewWorld& world) {
  std::vector<std::optional<GpuFivOccluder>> found(world.objects.size());
  std::vector<FivTable> tables;
  for (const auto& asset : assets) {
    const auto* table = std::get_if<FivTable>(&asset->data);
    if (table == nullptr) continue;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const ViewObject& object = world.objects[i];
      if (!object.moves || found[i]) continue;
      const std::vector<bool> all(object.scene->instances.size(), true);
      if (const std::optional<FivPlacement> placement = find_placement(*table, *object.scene, all))
        found[i] = GpuFivOccluder{int(tables.size()), placement->center_m, placement->radius_m};
    }
    tables.push_back(*table);
  }
  if (tables.empty()) return std::nullopt;
  std::optional<GpuFivTables> gpu = upload(tables);
  const auto exchange = [&] {
    for (std::size_t i = 0; i < found.size(); ++i) std::swap(world.objects[i].occluder, found[i]);
  };
  exchange();
  try {
    place_occluders(*gpu, world);
  } catch (...) {
    exchange();
    throw;
  }
  return gpu;
}

void place_occluders(GpuFivTables& tables, const ViewWorld& world) {
  std::vector<GpuFivOccluder> now;
  for (const std::size_t i : occluding_objects(world)) {
    now.push_back(*world.objects[i].occluder);
    now.back().center_m += place(world.objects[i], world.time_s);
  }
  set_occluders(tables, now);
}

int occluder_index(const ViewWorld& world, std::size_t object) {
  const std::vector<std::size_t> order = occluding_objects(world);
  const auto at = std::find(order.begin(), order.end(), object);
  return at == order.end() ? -1 : int(at - order.begin());
}

}  // namespace ivory
