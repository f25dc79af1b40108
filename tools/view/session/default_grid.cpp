#include "tools/view/session/default_grid.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/env/turned_map.h"
#include "grid/field/resolve.h"
#include "grid/io/vdb/vdb.h"
#include "tracer/bake/field/baker.h"

namespace ivory {

bool is_lit_by_assets(const ViewSession& session) {
  return std::any_of(session.assets.begin(), session.assets.end(), [](const auto& asset) { return asset->given; });
}

void bake_default_grid(ViewSession& session, const std::string& save_grid, const CommonOptions& common) {
  Scene scene = session.world.scene();
  const double turn_deg = session.environment_turn_deg;
  if (session.environment_map) scene.environment = turned(*session.environment_map, turn_deg);
  const LitScene lit = make_lit_scene(std::move(scene));
  if (lit.lights.empty()) {
    if (!save_grid.empty()) {
      throw Error(session.world.scene().name, "has no light to bake, and no environment is given",
                  "give --env, or leave out --save-grid");
    }
    session.notes.emplace_back("note: nothing shines, and no asset is given: give --env, a grid or another asset");
    return;
  }
  GridBakeParams params;
  params.threads = thread_count(common);
  params.lattice = default_lattice(*lit.scene, params);
  constexpr std::uint64_t photons_a_vertex = 128;
  params.photons = std::max<std::uint64_t>(1'000'000, photons_a_vertex * params.lattice->vertex_count());
  params.threads = affordable_threads(lit, *params.lattice, params);
  const auto start = std::chrono::steady_clock::now();
  GridAccumulator sums = [&] {
    Progress progress(common, "baking the scene's indirect light", "photons");
    params.progress = progress.callback();
    return bake_grid_sums(lit, params);
  }();
  for (const auto& [key, value] : session.scene_facts) sums.metadata[key] = value;
  for (const auto& [key, value] : session.environment_facts) sums.metadata[key] = value;
  if (session.environment_map && turn_deg != 0) sums.metadata["environment_turn_deg"] = turn_deg;
  sums.metadata["version"] = std::string(IVORY_VERSION);
  IrradianceGrid grid = resolve(sums);
  if (!save_grid.empty()) write_vdb(save_grid, grid, common.force);
  const GridFrame& frame = params.lattice->finest_frame();
  session.notes.push_back(
      fmt::format("note: no asset was given: baked indirect light into {}x{}x{} vertices {:.3g} m apart by {} photons "
                  "in {:.1f} s{}; its error is not measured (ivory bake grid --target-error)",
                  frame.size.x, frame.size.y, frame.size.z, frame.spacing_m.x, format_count(double(params.photons)),
                  std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                  save_grid.empty() ? "" : ", kept as " + save_grid));
  session.assets.push_back(make_view_grid(save_grid.empty() ? "grid baked at the start" : save_grid, grid));
  if (session.debug_grid == nullptr) session.debug_grid = session.assets.back().get();
}

}  // namespace ivory
