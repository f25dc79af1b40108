#include "tracer/bake/field/baker.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "grid/base/error.h"
#include "tracer/bake/field/deposit/photon_deposit.h"
#include "tracer/bake/field/guard_fit.h"
#include "tracer/bake/field/kept_vertices.h"
#include "tracer/bake/field/lit_vertices.h"
#include "tracer/bake/field/pilot.h"
#include "tracer/bake/field/vertex_visibility.h"
#include "tracer/render/photons/tracer.h"

namespace ivory {
namespace {

constexpr std::uint64_t scout_photons_a_vertex = 4;
constexpr std::uint64_t photons_a_batch = 2048;  // about 10,000 segments: they stay in the second-level cache

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

Metadata describe(const Scene& scene, const GridBakeParams& params, const Lattice& lattice, std::uint64_t photons,
                  const SumLayout& layout, const Pilot& pilot, const Lights::Emission& unguided) {
  Metadata m;
  m["method"] = std::string("irradiance grid");
  m["basis"] = std::string(name_of(params.basis));
  m["estimator"] = std::string(name_of(params.estimator));
  if (params.groups) {
    std::vector<std::string> of_lamp;
    for (std::size_t i = 0; i < scene.lights.size(); ++i)
      of_lamp.push_back(params.groups->names[std::size_t(params.groups->of_light[i])]);
    if (!of_lamp.empty()) m[lamp_groups_key] = fmt::format("{}", fmt::join(of_lamp, " "));
  }
  m["guard"] = std::string(params.guard == Guard::off ? "off" : "on");  // rays and planes bake the same
  m["photons"] = static_cast<std::int64_t>(photons);
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
  m["sum_slots"] = static_cast<std::int64_t>(layout.slots);
  m["emission"] = std::string(name_of(params.emission));
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
  return m;
}

// The sums of each group, the first of which `result` has, and in their place there those of all.
void add_groups(GridAccumulator& result, const LightGroups& groups, std::vector<DepositTarget>& targets) {
  for (std::size_t group = 0; group < targets.size(); ++group) {
    std::vector<std::int64_t> sums =
        group == 0 ? result.sums : to_accumulator(std::exchange(targets[group], DepositTarget{})).sums;
    if (group != 0) {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sums.size(), 1 << 16), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) result.sums[i] += sums[i];
      });
    }
    result.groups.push_back({groups.names[group], std::move(sums)});
  }
}

}  // namespace

GridAccumulator bake_grid_sums(const LitScene& lit, const GridBakeParams& params) {
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
  const std::uint64_t begin = range.first;  // Clang 14 does not capture structured bindings
  const std::uint64_t end = range.second;
  if (begin >= end || end > photons) {
    throw ParameterError("photon_range", "it must be A:B with A below B and B at most the " + std::to_string(photons) +
                                             " photons of the whole bake");
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
  std::vector<float> visible_fraction = visible_fractions(masks);
  std::vector<GuardRecord> guard;
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
    guard = fit_guard(lit.intersector, lattice, visible_fraction, reached);
  }

  const Lights::PhotonPower power = tracer.emission().photon_power();
  // As affordable_threads() reckoned before there was a guide: most photons are near the strongest.
  const int fine = fine_bits(unguided.photon_power());
  // One for each group of lights: what they add up to is what one would have.
  const std::size_t groups = params.groups ? params.groups->names.size() : 1;
  std::vector<DepositTarget> targets;
  targets.reserve(groups);
  targets.push_back(make_deposit_target(lattice, params.basis, params.estimator, power.strongest_lm, std::move(masks),
                                        fine, power.heaviest_lm, choose_buffers(vertices * groups, layout, fine)));
  while (targets.size() < groups) targets.push_back(targets.front());
  struct Worker {
    std::vector<PhotonDepositor> depositors;  // [group]
    std::vector<std::vector<PhotonSegment>> of_group;
    std::vector<PhotonSegment> segments;
    PhotonLedger ledger;
  };
  const auto deposit = [&](Worker& worker) {
    if (!params.groups) return worker.depositors.front().deposit(worker.segments);
    for (const PhotonSegment& segment : worker.segments)
      worker.of_group[std::size_t(params.groups->of_light[std::size_t(segment.light)])].push_back(segment);
    for (std::size_t group = 0; group < groups; ++group) {
      worker.depositors[group].deposit(worker.of_group[group]);
      worker.of_group[group].clear();
    }
  };
  // One for each of the arena's slots: over time more threads may take part than at once.
  tbb::task_arena arena(threads);
  std::vector<std::unique_ptr<Worker>> workers(static_cast<std::size_t>(threads));
  std::mutex progress_mutex;
  std::uint64_t done = 0;
  // As many of each group: their sums, too, are found in the cache when there are several to add.
  const std::uint64_t batch_photons = photons_a_batch * groups;
  const std::uint64_t batches = (end - begin + batch_photons - 1) / batch_photons;
  const auto trace_batches = [&](const tbb::blocked_range<std::uint64_t>& batch_range) {
    std::unique_ptr<Worker>& own = workers[std::size_t(tbb::this_task_arena::current_thread_index())];
    if (!own) {
      own = std::make_unique<Worker>();
      own->depositors.reserve(groups);
      for (DepositTarget& target : targets) own->depositors.emplace_back(target);
      own->of_group.resize(groups);
    }
    Worker& worker = *own;
    for (std::uint64_t batch = batch_range.begin(); batch < batch_range.end(); ++batch) {
      const std::uint64_t first = begin + batch * batch_photons;
      const std::uint64_t last = std::min(first + batch_photons, end);
      worker.segments.clear();
      tracer.trace(first, last, worker.segments, worker.ledger);
      deposit(worker);
      if (params.progress) {
        const std::lock_guard lock(progress_mutex);
        done += last - first;
        params.progress(done, end - begin);
      }
    }
  };
  arena.execute([&] { tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, batches, 4), trace_batches); });
  PhotonLedger ledger;
  for (const std::unique_ptr<Worker>& worker : workers) {
    if (!worker) continue;
    for (PhotonDepositor& depositor : worker->depositors) depositor.flush();
    ledger += worker->ledger;
  }

  workers.clear();
  GridAccumulator result = to_accumulator(std::move(targets.front()));
  if (params.groups) add_groups(result, *params.groups, targets);
  result.anchor_m = scene.anchor_m;
  result.visible_fraction = std::move(visible_fraction);
  result.guard = std::move(guard);
  result.light = stored_light(params.include_direct);
  result.photon_begin = begin;
  result.photon_end = end;
  result.counters = {{"ledger_emitted", ledger.emitted}, {"ledger_absorbed", ledger.absorbed},
                     {"ledger_escaped", ledger.escaped}, {"ledger_terminated", ledger.terminated},
                     {"photons_traced", ledger.photons}, {"rays_traced", ledger.rays}};
  result.metadata = describe(scene, params, result, photons, layout, pilot, unguided);
  result.metadata["ledger_unit_lm"] = tracer.ledger_unit_lm();
  return result;
}

}  // namespace ivory
