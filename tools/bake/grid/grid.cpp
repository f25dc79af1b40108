// ivory bake grid: photons through a scene into an irradiance-vector grid.
#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/field/resolve.h"
#include "grid/io/file.h"
#include "grid/io/vdb/vdb.h"
#include "tools/bake/checkpoint.h"
#include "tools/bake/facts.h"
#include "tools/bake/grid/contract.h"
#include "tools/bake/grid/parse.h"
#include "tools/bake/grid/probes.h"
#include "tools/bake/grid/report.h"
#include "tools/bake/grid/result.h"
#include "tools/bake/grid/shards.h"
#include "tools/cli/box.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/scene.h"
#include "tracer/bake/field/baker.h"
#include "tracer/bake/field/deposit/target.h"

namespace ivory {

namespace {

struct BakeGridOptions {
  std::string scene;
  std::string output;
  SceneOptions load;
  EnvironmentChoice environment;
  std::optional<Imath::Box3d> bounds;  // in the world
  std::vector<std::string> dynamic;    // regions
  std::vector<std::string> groups;
  std::uint64_t seed = 1;
  GridBakeParams params;
  GridContractOptions contract;
  CheckpointOptions checkpoint;
  ShardOptions shards;
  ProbeBakeOptions probes;
};

Box3f local_box(const Imath::Box3d& box, const V3d& anchor_m) {
  return {to_local(box.min, anchor_m), to_local(box.max, anchor_m)};
}

// The input's first.
void put_input_warnings(const SceneInput& input, nlohmann::ordered_json& result) {
  nlohmann::ordered_json warnings = input.warnings;
  if (result.contains("warnings"))
    warnings.insert(warnings.end(), result["warnings"].begin(), result["warnings"].end());
  result["warnings"] = std::move(warnings);
}

// To an error: `bake` holds what is given of spacing and photons.
void run_contract(const BakeGridOptions& options, const GridBakeParams& bake, const SceneInput& input,
                  const CommonOptions& common) {
  const V3d& anchor_m = input.lit.scene->anchor_m;
  ContractParams params = contract_params(options.contract, bake, anchor_m, common);
  if (options.contract.dry_run) {
    const GridPlan plan = plan_grid(input.lit, params);
    nlohmann::ordered_json result{{"plan", plan_json(plan, params.target, anchor_m)}};
    put_input_warnings(input, result);
    return print_result(common, result, plan_text(plan, params.target));
  }
  Metadata origin = input.origin;
  origin["version"] = std::string(IVORY_VERSION);
  CheckpointOptions checkpoint = options.checkpoint;
  if (params.most_seconds) checkpoint.minutes = 0;
  KeptCheckpoint kept(checkpoint, options.output, origin, common);
  const auto start = std::chrono::steady_clock::now();
  ContractResult contract = [&] {
    Progress progress(common, "baking", "photons");
    params.bake.checkpoint = kept.policy(progress);
    params.note = [&](const std::string& line) { progress.note(line); };
    params.bake.progress = progress.callback();
    return bake_to_error(input.lit, params);
  }();
  kept.baked();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  check_voxels(options.output, contract.sums.finest_frame());
  keep_origin(input.origin, contract.sums);
  const GridContractOptions& asked = options.contract;
  keep_contract(contract, asked.points.empty() ? std::string(name_of(asked.domain)) : "points",
                asked.target.has_value(), asked.most_seconds);
  std::string report;
  if (!options.contract.report.empty() && contract.certificate)
    report = grid_report(options.output, input.lit, resolve(contract.sums), contract, params.lookup);
  auto result = write_result(options.output, std::move(contract.sums), /*finished=*/true, common);
  if (!report.empty()) {
    write_file(options.contract.report, report, common.force);
    result["report"] = options.contract.report;
  }
  result["plan"] = plan_json(contract.plan, params.target, anchor_m);
  result["seconds"] = seconds;
  put_input_warnings(input, result);
  kept.finish(result);
  add_contract_result(contract, options.contract, result, common);
  print_result(common, result,
               result_text(result) + contract_text(contract) +
                   fmt::format("{:.2f} s on {} threads, pilots and certificate included\n", seconds, bake.threads));
}

void run_bake_grid(const BakeGridOptions& options, const CommonOptions& common) {
  GridBakeParams params = options.params;
  params.seed = options.seed;
  const std::vector<Imath::Box3d> regions = parse_regions(options.dynamic);
  const std::vector<LightGroupRule> rules = parse_groups(options.groups);
  params.threads = thread_count(common);
  sum_layout(params.basis, params.estimator);  // refuses bases that the estimator cannot fill
  if (params.photon_range && params.photons != 0 && params.photon_range->second > params.photons) {
    throw UsageError(fmt::format("--photon-range ends at {}, past the {} of --photons", params.photon_range->second,
                                 params.photons));
  }
  if (options.shards.count != 0) {
    check_shards(options.shards, options.contract.target || options.contract.dry_run);
    params.photon_range = {{0, 1}};  // some: which, is known with the photons of the whole
  }
  const bool contract = has_contract(options.contract, params);
  check_probe_bake(options.probes, params, contract, options.checkpoint.is_given);
  if (contract && params.levels > 1) {
    throw UsageError(
        "--levels: a bake to an error chooses its levels itself; give --voxel-size or --resolution and --photons "
        "instead of --target-error or --dry-run");
  }
  if (contract && params.include_direct && !params.include_direct.all()) {
    throw UsageError(
        "--direct-of: an error is certified of all direct light or of none; give --voxel-size or "
        "--resolution, and --photons, instead of --target-error or --dry-run");
  }
  if (options.checkpoint.is_given && options.checkpoint.minutes > 0 && options.contract.most_seconds)
    throw UsageError("--checkpoint: what --max-time decides by the clock cannot be gone on from; give one of the two");
  params.max_memory_bytes = options.contract.most_memory_bytes;
  if (!options.contract.dry_run) check_output(options.output, ".vdb", common);
  if (!options.contract.report.empty() && !options.contract.dry_run)
    check_output(options.contract.report, ".html", common);

  const auto input =
      load_scene_input(options.scene, options.load, options.environment, common, [&](const Scene& scene) {
        if (options.bounds) params.bounds = local_box(*options.bounds, scene.anchor_m);
        if (!options.dynamic.empty()) params.dynamic_regions.emplace();
        for (const Imath::Box3d& region : regions) params.dynamic_regions->push_back(local_box(region, scene.anchor_m));
        // Before what takes time is built of the scene.
        const Lattice placed = default_lattice(scene, params);
        check_estimator(placed, params.estimator);
        check_voxels(options.output, placed.finest_frame());
        // What a contract chooses has about that spacing, and memory bounds it.
        if (contract && !params.resolution && !params.voxel_size_m) return;
        check_grid_memory(scene, placed, params);
        if (options.shards.count != 0) {
          if (params.photons == 0) params.photons = default_photons(placed.vertex_count());
          params.photon_range = photons_of(options.shards, params.photons);
        }
        if (contract) {
          params.frame = placed.frame;
        } else {
          params.lattice = placed;
        }
      });
  if (!options.groups.empty()) params.groups = make_light_groups(input.lit.lights, *input.lit.scene, rules);
  if (contract) return run_contract(options, params, input, common);
  if (options.probes) return run_probe_bake(options.output, options.probes, params, input, common);
  const Lattice& lattice = *params.lattice;
  if (const int threads = affordable_threads(input.lit, lattice, params); threads < params.threads) {
    print_note(common, fmt::format("note: {} threads instead of {}: each needs memory for the whole grid", threads,
                                   params.threads));
    params.threads = threads;
  }
  Metadata origin = input.origin;
  origin["version"] = std::string(IVORY_VERSION);
  KeptCheckpoint kept(options.checkpoint, options.output, origin, common);
  const auto start = std::chrono::steady_clock::now();
  GridAccumulator sums = [&] {
    Progress pilot(common, "pilot", "photons");
    params.pilot_progress = pilot.callback();
    Progress progress(common, "baking", "photons");
    const GridFrame& frame = lattice.finest_frame();
    const std::string vertices =
        lattice.levels() == 1 ? fmt::format("{}x{}x{} vertices,", frame.size.x, frame.size.y, frame.size.z)
                              : fmt::format("{} vertices on {} levels,", lattice.vertex_count(), lattice.levels());
    progress.note(fmt::format("{} {:.4g} x {:.4g} x {:.4g} m apart{}; finding what each sees", vertices,
                              frame.spacing_m.x, frame.spacing_m.y, frame.spacing_m.z,
                              lattice.levels() == 1 ? "" : " on the finest"));
    params.progress = progress.callback();
    params.checkpoint = kept.policy(progress);
    return bake_grid_sums(input.lit, params);
  }();
  kept.baked();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  keep_origin(input.origin, sums);

  const double rate = static_cast<double>(sums.photon_end - sums.photon_begin - kept.done_before()) / seconds;
  auto result = write_result(options.output, std::move(sums), /*finished=*/!params.photon_range, common);
  result["seconds"] = seconds;
  result["photons_per_second"] = rate;
  put_input_warnings(input, result);
  kept.finish(result);
  print_result(common, result,
               result_text(result) +
                   fmt::format("{:.2f} s, {} photons/s on {} threads\n", seconds, format_count(rate), params.threads));
}

}  // namespace

void add_bake_grid_command(Command bake, CommonOptions& common) {
  Command command = bake.add_subcommand("grid", "Bake a scene's indirect light into an irradiance-vector grid (.vdb)");
  auto options = std::make_shared<BakeGridOptions>();
  GridBakeParams& params = options->params;
  command.add_option("scene", options->scene, "Scene: .gltf or .glb, metres, +Y up").required().type_name("SCENE");
  command.add_option("-o,--output", options->output, "Grid to write, .vdb").required().type_name("OUT.vdb");
  command
      .add_option(
          "--bounds", [options](const std::string& text) { options->bounds = parse_bounds("--bounds", text); },
          "What the grid covers, in metres: the rest of the scene sends light and shadows into it but\n"
          "stores none, and points outside read the nearest vertices [the whole scene]")
      .type_name("X0,Y0,Z0:X1,Y1,Z1");
  command
      .add_option("--rotate-y", params.rotate_y_deg,
                  "Turns the grid about the vertical axis through its middle, counter-clockwise as seen from\n"
                  "above: --bounds is given before the turn; without it the turned grid covers the whole scene")
      .within(-360.0, 360.0)
      .type_name("DEGREES");

  Option resolution = command.add_option(
      "--resolution", [&params](const std::string& text) { params.resolution = parse_size3("--resolution", text, 2); },
      "Vertices along x, y and z, or one number for all [chosen by the error]");
  resolution.type_name("NX,NY,NZ");
  command
      .add_option("--voxel-size", params.voxel_size_m, "Distance between vertices in metres, the same along x, y and z")
      .positive()
      .type_name("METRES")
      .excludes(resolution);
  command.add_count("--levels", params.levels, 1, max_levels,
                    "Spacings side by side: the one asked for near surfaces and in --dynamic boxes, and up to\n"
                    "2^(N-1) times that in the open; 1 is the same everywhere");
  command
      .add_option("--dynamic", options->dynamic,
                  "Where objects will move: a box X0,Y0,Z0:X1,Y1,Z1 in metres, or none; may be repeated. Away from\n"
                  "surfaces only vertices in these are stored [everywhere]")
      .repeated()
      .type_name("none|BOX");
  command
      .add_option(
          "--photons",
          [&params](const std::string& text) {
            params.photons = parse_count("--photons", text);
            if (params.photons == 0) throw UsageError("--photons must be at least 1");
          },
          "Photons of the whole bake; k, m, g are allowed [chosen by the error; 256 a vertex, at least 1m,\n"
          "where the spacing is given]")
      .type_name("COUNT");
  Option range = command.add_option(
      "--photon-range",
      [&params](const std::string& text) { params.photon_range = parse_range("--photon-range", text); },
      "Trace photons A to B-1 of --photons only and write their sums, a part\nfor 'ivory merge'");
  range.type_name("A:B");
  add_shard_options(command, range, options->shards);
  command.add_count("--seed", options->seed, "Seed of the random numbers");
  command.add_count("--bounces", params.max_bounces, 1, 1'000'000,
                    "Surfaces a photon may scatter at; Russian roulette ends most before");
  command
      .add_option("--groups", options->groups,
                  "Keeps the light of some lamps apart, for 'ivory mix' and the viewer: a group's name and its nodes'\n"
                  "names by a shell's patterns, @environment or @suns; may be repeated. Other lights go by\n"
                  "extras.ivory_group of their nodes (to ask for that alone: extras), the others to group 'rest'")
      .repeated()
      .type_name("GROUP=PATTERN,..|extras");
  Option direct = command.add_flag(
      "--direct", [&params] { params.include_direct = true; }, "Store light straight from its sources too");
  command
      .add_option(
          "--direct-of", [&params](const std::string& text) { params.include_direct = parse_direct(text); },
          "The same of some sources: punctual, area (emissive surfaces, spherical lights), sky (the environment,\n"
          "its sun included). What reads the grid adds the others, and none twice")
      .type_name("KIND,..")
      .excludes(direct);
  add_environment_options(command, options->environment);
  add_scene_options(command, options->load);
  add_portable_option(command, options->load);
  command.add_choice(
      "--emission", params.emission,
      "Where photons are sent: where a pilot found that they come to the grid, more into dark places\n"
      "(guided); suns and skies at its bounds (bounds) or over the whole scene (even). Means are the same");
  command.add_choice("--basis", params.basis, "Directional basis stored at each vertex");
  command.add_choice("--estimator", params.estimator,
                     "How photons count: by the length of their path in a cell (track), by the faces they cross,\n"
                     "divided by the cosine (face), or as published (face_paper); both fill basis vectors only");
  command.add_choice("--guard", params.guard,
                     "Leak guard: rays and planes count only light that a vertex sees and store its\n"
                     "compact guard; off does neither");
  add_probe_bake_options(command, options->probes);
  add_checkpoint_option(
      command, options->checkpoint,
      "Keeps what is done so far in OUT.checkpoint.vdb, so often and at Ctrl-C or SIGTERM: after whatever\n"
      "stopped it, the same command goes on from there, to the same bytes. 0 keeps none");
  add_grid_contract_options(command, options->contract);
  command.footer(
      "The same command gives the same bytes with any --threads, and however often it was stopped.\n"
      "\nExamples:\n"
      "  ivory bake grid room.glb -o room.vdb --target-error 2%\n"
      "  ivory bake grid room.glb -o room.vdb --resolution 48,24,48 --photons 16m\n"
      "  ivory bake grid street.glb -o room.vdb --bounds -3,0,-2:3,2.8,2 --rotate-y 30   (one room, not the sky dome)\n"
      "  ivory bake grid room.glb -o b.vdb --photons 16m --photon-range 8m:16m   (one machine's half; see ivory "
      "merge)");
  set_action(command, common, Output::file, [options, &common] { run_bake_grid(*options, common); });
}

}  // namespace ivory
