#include "tools/view/session/occluders.h"

#include "grid/base/error.h"
#include "tracer/bake/fiv/occluder.h"

namespace ivory {

ViewOccluders find_occluders(const ViewAssets& assets, const ViewWorld& world) {
  ViewOccluders found;
  found.of_object.assign(world.objects.size(), -1);
  std::vector<FivTable> tables;
  for (const auto& asset : assets) {
    if (!asset->fiv) continue;
    for (std::size_t i = 0; i < world.objects.size(); ++i) {
      const ViewObject& object = world.objects[i];
      if (!object.moves || found.of_object[i] >= 0) continue;
      const std::vector<bool> all(object.scene->instances.size(), true);
      const std::optional<FivPlacement> placement = find_placement(*asset->fiv, *object.scene, all);
      if (!placement) continue;
      found.of_object[i] = int(found.own.size());
      found.own.push_back({int(tables.size()), placement->center_m, placement->radius_m});
      found.object_of.push_back(i);
    }
    tables.push_back(*asset->fiv);
  }
  if (tables.empty()) return found;
  found.gpu = upload(tables);
  place_occluders(found, world);
  return found;
}

void remove_occluder(ViewOccluders& occluders, std::size_t object) {
  if (object >= occluders.of_object.size()) return;
  const int removed = occluders.of_object[object];
  occluders.of_object.erase(occluders.of_object.begin() + std::ptrdiff_t(object));
  if (removed >= 0) {
    occluders.own.erase(occluders.own.begin() + removed);
    occluders.object_of.erase(occluders.object_of.begin() + removed);
    for (int& index : occluders.of_object) index -= index > removed ? 1 : 0;
  }
  for (std::size_t& index : occluders.object_of) index -= index > object ? 1 : 0;
}

void place_occluders(ViewOccluders& occluders, const ViewWorld& world) {
  if (!occluders.gpu) return;
  std::vector<GpuFivOccluder> now = occluders.own;
  for (std::size_t i = 0; i < now.size(); ++i)
    now[i].center_m += place(world.objects[occluders.object_of[i]], world.time_s);
  set_occluders(*occluders.gpu, now);
}

}  // namespace ivory
