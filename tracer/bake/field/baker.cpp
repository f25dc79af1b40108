#include "tracer/bake/field/baker.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "grid/base/error.h"
#include "tracer/bake/field/deposit/photon_sums.h"
#include "tracer/bake/field/grid_checkpoint.h"
#include "tracer/bake/field/guard_fit.h"
#include "tracer/bake/field/kept_vertices.h"
#include "tracer/bake/field/lit_vertices.h"
#include "tracer/bake/field/pilot.h"
#include "tracer/bake/field/vertex_visibility.h"
#include "tracer/render/photons/tracer.h"

namespace ivory {
namespace {

constexpr std::uint64_t scout_photons_a_vertex = 4;

// A local coordinate in the world, as the command line takes it.
std::string text_of(float x, double anchor) {
  return anchor == 0 ? fmt::format("{}", x) : fmt::format("{:.12g}", double(x) + anchor);
}

// "-1,0,2:3,4,5 ..." as the command line takes them; "none".
std::string text_of(const std::vector<Box3f>& boxes, const V3d& anchor) {
  std::string text;
  const auto corner = [&](const V3f& p) {
    return fmt::format("{},{},{}", text_of(p.x, anchor.x), text_of(p.y, anchor.y), text_of(p.z, anchor.z));
  };
  for (const Box3f& b : boxes) text += fmt::format("{}{}:{}", text.empty() ? "" : " ", corner(b.min), corner(b.max));
  return text.empty() ? "none" : text;
}

}  // namespace

Metadata grid_facts(const Scene& scene, const GridBakeParams& params, const Lattice& lattice) {
  Metadata m;
  m["method"] = std::string("irradiance grid");
  m["basis"] = std::string(name_of(params.basis));
  if (params.groups) {
    std::vector<std::string> of_lamp;
    for (std::size_t i = 0; i < scene.lights.size(); ++i)
      of_lamp.push_back(params.groups->names[std::size_t(params.groups->of_light[i])]);
    if (!of_lamp.empty()) m[lamp_groups_key] = fmt::format("{}", fmt::join(of_lamp, " "));
  }
  m["guard"] = std::string(params.guard == Guard::off ? "off" : "on");  // rays and planes bake the same
  m["max_bounces"] = static_cast<std::int64_t>(params.max_bounces);
  m["seed"] = static_cast<std::int64_t>(params.seed);
  m["scene"] = scene.name;
  m["scene_hash"] = scene.content_hash;
  m["dynamic_regions"] =
      params.dynamic_regions ? text_of(*params.dynamic_regions, scene.anchor_m) : std::string("everywhere");
  m["bounds"] = params.bounds ? text_of({*params.bounds}, scene.anchor_m) : std::string("scene");
  m["rotate_y_deg"] = double(params.rotate_y_deg);
  if (lattice.levels() > 1) {
    std::string spacings;
    std::string counts;
    for (int level = 0; level < lattice.levels(); ++level) {
      spacings += fmt::format("{}{:.6g}", level == 0 ? "" : " ", lattice.frame_of(level).spacing_m.x);
      counts += fmt::format("{}{}", level == 0 ? "" : " ", lattice.vertex_count_of(level));
    }
    m["levels"] = std::int64_t(lattice.levels());
    m["level_spacings_m"] = spacings;  // along the grid's x
    m["level_vertices"] = counts;
  }
  m["units"] = std::string("lux");
  return m;
}

namespace {

// What is known before a photon flies.
Metadata describe(const Scene& scene, const GridBakeParams& params, const Lattice& lattice, std::uint64_t photons) {
  Metadata m = grid_facts(scene, params, lattice);
  m["estimator"] = std::string(name_of(params.estimator));
  m["photons"] = static_cast<std::int64_t>(photons);
  m["sum_slots"] = static_cast<std::int64_t>(sum_layout(params.basis, params.estimator).slots);
  m["emission"] = std::string(name_of(params.emission));
  return m;
}

void describe_emission(const Pilot& pilot, const Lights::Emission& unguided, Metadata& m) {
  m["pilot_photons"] = static_cast<std::int64_t>(pilot.photons);
  if (pilot.photons != 0) {
    m["pilot_reach_unguided"] = pilot.reach_before;
    m["pilot_reach_guided"] = pilot.reach_after;
    m["pilot_cells"] = static_cast<std::int64_t>(pilot.emission.is_guided() ? pilot.emission.guide().cells() : 0);
  }
  if (const std::vector<double>& radii_m = unguided.discs().radii_m; !radii_m.empty()) {
    std::string text;
    for (const double radius_m : radii_m) text += fmt::format("{}{:.6g}", text.empty() ? "" : " ", radius_m);
    m["entry_discs_m"] = text;
    m["photon_power_lm"] = double(unguided.photon_power().strongest_lm);
  }
}

// Traces what is missing of photons [bake.photon_begin, end) into `sums`, with checkpoints; bake.photon_end says what
// is there.
void trace_with_checkpoints(PhotonSums& sums, GridAccumulator& bake, std::uint64_t end, const GridBakeParams& params,
                            GridCheckpoint* checkpoint) {
  const std::uint64_t begin = bake.photon_begin;
  for (;;) {
    const std::uint64_t first = bake.photon_end;
    bake.photon_end = sums.trace(first, end, [&](std::uint64_t done) {
      if (params.progress) params.progress(first + done - begin, end - begin);
      return checkpoint != nullptr && checkpoint->is_wanted();
    });
    // Asked at the very end, too: what comes after may take longer than who wants to leave is to wait.
    const bool is_stopping = checkpoint != nullptr && checkpoint->is_to_stop();
    if (bake.photon_end == end && !is_stopping) return;
    sums.take(bake);
    checkpoint->write(bake);
    if (is_stopping) checkpoint->stop(bake.photon_end);
    sums.put(bake);
  }
}

}  // namespace

GridAccumulator bake_grid_sums(const LitScene& lit, const GridBakeParams& params,
                               std::optional<GridAccumulator> at_hand) {
  const Scene& scene = *lit.scene;
  if (lit.lights.empty())
    throw Error(scene.name, "nothing in it shines", "add a light, an emissive material or an environment");
  const Lattice lattice = params.lattice ? *params.lattice : default_lattice(scene, params);
  const std::size_t vertices = lattice.vertex_count();
  check_estimator(lattice, params.estimator);
  const SumLayout layout = sum_layout(params.basis, params.estimator);
  const int threads = affordable_threads(lit, lattice, params);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));

  const std::uint64_t photons = params.photons != 0 ? params.photons : default_photons(vertices);
  const auto range = params.photon_range.value_or(std::pair<std::uint64_t, std::uint64_t>{0, photons});
  if (range.first >= range.second || range.second > photons) {
    throw ParameterError("photon_range", "it must be A:B with A below B and B at most the " + std::to_string(photons) +
                                             " photons of the whole bake");
  }

  GridAccumulator result;
  result.photon_begin = at_hand ? at_hand->photon_begin : range.first;
  result.light = stored_light(params.include_direct);
  result.anchor_m = scene.anchor_m;
  result.metadata = describe(scene, params, lattice, photons);
  std::optional<GridCheckpoint> checkpoint;
  if (params.checkpoint) {
    checkpoint.emplace(params, lattice, result.metadata, checkpoint_cpu(lit.intersector.portable()),
                       result.photon_begin, range.second);
  }

  std::vector<std::uint64_t> masks = params.guard == Guard::off
                                         ? std::vector<std::uint64_t>(vertices, ~std::uint64_t(0))
                                         : vertex_cell_masks(lit.intersector, lattice);
  if (params.dynamic_regions) {
    // Finer levels have bricks only where they are wanted.
    const std::vector<bool> kept = kept_vertices(scene, lattice.frame, *params.dynamic_regions);
    for (std::size_t v = 0; v < kept.size(); ++v) {
      if (!kept[v]) masks[v] = 0;
    }
  }
  result.visible_fraction = visible_fractions(masks);
  const Lights::Emission unguided = lit.lights.emission(emission_target(lattice.finest_frame(), params));
  // What photons find out beforehand is found by as many whether the bake then ends or goes on.
  const std::uint64_t pilot_photons = params.pilot_for_photons != 0 ? params.pilot_for_photons : photons;
  Pilot pilot{unguided, nullptr, std::nullopt};
  if (params.emission == EmissionMode::guided) {
    pilot = run_pilot(lit, lattice.finest_frame(), unguided,
                      {.photons = pilot_photons,
                       .max_bounces = params.max_bounces,
                       .include_direct = params.include_direct,
                       .seed = params.seed,
                       .progress = params.pilot_progress});
  }
  const PhotonTracer tracer(lit, {.max_bounces = params.max_bounces,
                                  .include_direct = params.include_direct,
                                  .seed = params.seed,
                                  .emission = pilot.emission,
                                  .window = pilot.window,
                                  .aim = pilot.aim});
  if (params.guard != Guard::off) {
    const std::uint64_t scouts = std::min(pilot_photons, scout_photons_a_vertex * vertices);
    const std::vector<bool> reached = lit_vertices(tracer, lattice, masks, scouts);
    result.guard = fit_guard(lit.intersector, lattice, result.visible_fraction, reached);
  }

  const Lights::PhotonPower power = tracer.emission().photon_power();
  // As affordable_threads() reckoned before there was a guide: most photons are near the strongest.
  const int fine = fine_bits(unguided.photon_power());
  const std::size_t groups = params.groups ? params.groups->names.size() : 1;
  PhotonSums sums(tracer,
                  make_deposit_target(lattice, params.basis, params.estimator, power.strongest_lm, std::move(masks),
                                      fine, power.heaviest_lm, choose_buffers(vertices * groups, layout, fine)),
                  params.groups ? &*params.groups : nullptr, threads);
  describe_emission(pilot, unguided, result.metadata);
  result.metadata["ledger_unit_lm"] = tracer.ledger_unit_lm();
  result.photon_end = range.first;
  if (checkpoint && checkpoint->is_there()) {
    at_hand.reset();
    sums.take(result);  // none yet; what they have in common with the file's is of interest
    std::vector<std::int64_t>().swap(result.sums);
    for (SumGroup& group : result.groups) std::vector<std::int64_t>().swap(group.sums);
    at_hand = checkpoint->read(result);
  }
  if (at_hand) {
    if (at_hand->sums.empty())
      throw Error(scene.name, "the checkpoint that its bake went on from is gone", "start the same command again");
    result.photon_end = at_hand->photon_end;
    sums.put(*at_hand);
    at_hand.reset();
  }
  trace_with_checkpoints(sums, result, range.second, params, checkpoint ? &*checkpoint : nullptr);
  sums.take(result);
  return result;
}

}  // namespace ivory
