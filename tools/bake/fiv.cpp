// ivory bake fiv: an occluder table of a mesh under an environment.
#include "grid/io/fiv.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/base/half.h"
#include "grid/base/memory.h"
#include "grid/env/environment_image.h"
#include "grid/env/irradiance.h"
#include "grid/env/latlong_map.h"
#include "grid/io/environment.h"
#include "grid/io/json.h"
#include "tools/bake/asset_contract.h"
#include "tools/bake/checkpoint.h"
#include "tools/bake/facts.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/assumptions.h"
#include "tools/input/environment.h"
#include "tools/input/scene.h"
#include "tracer/bake/fiv/choose.h"
#include "tracer/bake/fiv/turns.h"

namespace ivory {

namespace {

struct BakeFivOptions {
  std::string mesh;
  std::string output;
  SceneOptions load;
  EnvironmentChoice environment;
  std::string samples = "128,65,30";
  ExrPrecision precision = ExrPrecision::float32;
  FivParams params;
  AssetContract contract;
  int turns = 1;
};

// Receivers that samples are chosen at, and others that the result is judged at.
constexpr int pilot_receivers = 1500;
constexpr int certificate_receivers = 2000;
constexpr std::uint64_t pilot_seed = 1;
constexpr std::uint64_t certificate_seed = 2;

// Directions of an estimate of hidden light: an estimate's noise is at most some 5 % of E at 256, and its square, over
// the root of the number of receivers, is to stay well below the square of the error.
int truth_samples(const AssetContract& contract) {
  int samples = 256;
  for (double target = contract.target.value_or(0.01); target < 0.015 && samples < 8192; target *= 1.5) samples *= 2;
  return samples;
}

FivParams params_of(const BakeFivOptions& options) {
  FivParams params = options.params;
  params.samples = parse_size3("--samples", options.samples, 2);
  if (params.samples.x < 3) throw UsageError("--samples: at least 3 azimuths are needed");
  params.intersector = options.load.intersector;
  return params;
}

void check_size(const BakeFivOptions& options, const FivParams& params) {
  const double samples =
      double(params.samples.x) * double(params.samples.y) * double(params.samples.z) * double(options.turns);
  const double numbers = 3 * fiv_function_count(params.hemispheres);
  check_memory(options.output, fiv_bake_bytes(params), "ask for fewer --samples");
  if (samples * numbers > 2e9)
    throw UsageError("--samples: such a table would hold more than two thousand million numbers");
}

// The table as its file holds it in float16.
FivTable rounded(FivTable table) {
  for (float& value : table.values) value = rounded_to_half(value);
  return table;
}

// What the choice and the bake have come to.
struct Baked {
  FivSet set;
  FivTable& table() { return set.turns.front(); }
  const FivTable& table() const { return set.turns.front(); }
  MeasuredError predicted;  // where something was chosen or is only planned
};

Baked bake_table(const FivOccluder& occluder, const CubeMap& cube, const BakeFivOptions& options,
                 const FivParams& params, const FivTruth* pilot, bool hemispheres_given) {
  if (options.contract.target) {
    const std::vector<int> hemispheres =
        hemispheres_given ? std::vector<int>{params.hemispheres} : std::vector<int>{1, 6};
    FivChoice choice = choose_fiv(occluder, cube, params, *pilot, *options.contract.target, hemispheres);
    return {FivSet{{std::move(choice.table)}}, choice.predicted};
  }
  Baked baked{bake_fiv_turns(occluder, cube, params, options.turns), {}};
  if (pilot != nullptr) baked.predicted = fiv_error(baked.table(), *pilot);
  return baked;
}

BakePlan make_plan(const Baked& baked, ExrPrecision precision, double seconds) {
  BakePlan plan;
  const V3i& size = baked.table().size;
  plan.knobs["samples"] = fmt::format("{},{},{}", size.x, size.y, size.z);
  plan.knobs["hemispheres"] = baked.table().hemispheres;
  plan.seconds = within_factor(1.2 * seconds, 1.6);
  const double numbers = double(baked.table().values.size());
  plan.memory_bytes = within_factor(peak_memory_bytes(), 1.3);
  const double bytes = numbers * (precision == ExrPrecision::float32 ? 4 : 2);
  plan.file_bytes = {0.4 * bytes, 0.85 * bytes, bytes + 8192};
  plan.error = predicted_error(baked.predicted);
  return plan;
}

void run_bake_fiv(const BakeFivOptions& options, const Command& command, const CommonOptions& common) {
  const AssetContract& contract = options.contract;
  FivParams params = params_of(options);
  const bool hemispheres_given = command.get_option("--hemispheres").given();
  if (contract.target) {
    if (!command.get_option("--samples").given()) params.samples = most_fiv_samples;
    if (!hemispheres_given) params.hemispheres = 6;
  }
  check_size(options, params);
  if (options.turns > 1 && (contract.measures() || contract.dry_run)) {
    throw UsageError(
        "--turns: errors are chosen by, and certified of, one table; find --samples and --hemispheres without it");
  }
  check_output(options.output, ".exr", options.contract, common);
  MeshInput mesh = load_mesh_input(options.mesh, options.load, common);
  LoadedScene& loaded = mesh.loaded;
  EnvironmentInput environment = load_environment_input(options.environment, common);
  loaded.warnings.insert(loaded.warnings.end(), environment.warnings.begin(), environment.warnings.end());
  print_warnings(common, loaded.warnings);
  const FivOccluder occluder = make_fiv_occluder(loaded.scene);
  const EnvironmentMap map = to_latlong(std::move(environment.image));
  const CubeMap cube = fine_cube(map, params.environment_size);

  Progress progress(common, "baking", "directions");
  params.progress = progress.callback();
  const auto start = std::chrono::steady_clock::now();
  const auto trace_truth = [&](int receivers, std::uint64_t seed) {
    const IrradianceTree tree = make_irradiance_tree({EnvironmentLayout::latlong, map});
    return trace_fiv_truth(occluder, map, tree, {receivers, truth_samples(contract), seed});
  };
  std::optional<FivTruth> pilot;
  if (contract.target || contract.dry_run) pilot = trace_truth(pilot_receivers, pilot_seed);
  Baked baked = bake_table(occluder, cube, options, params, pilot ? &*pilot : nullptr, hemispheres_given);
  FivTable& table = baked.table();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (contract.dry_run) {
    print_plan(options.output, make_plan(baked, options.precision, seconds), contract, loaded.warnings, common);
    return;
  }

  Metadata& m = table.metadata = fiv_facts(mesh, occluder, params, environment.origin);
  if (options.turns > 1) m["turns"] = std::int64_t(options.turns);
  const V3d center = to_world(occluder.center_m, occluder.anchor_m);
  std::optional<Certificate> certificate;
  if (contract.measures()) {
    const FivTable stored = options.precision == ExrPrecision::float32 ? table : rounded(table);
    certificate = make_certificate(
        fiv_error(stored, trace_truth(certificate_receivers, certificate_seed)), contract,
        fmt::format("E at {} receivers of any normal, {:g} to {:g} bounding radii beyond planes that touch one "
                    "occluder, against traced light; RMS ÷ mean unshadowed E",
                    certificate_receivers, nearest_fiv_gap, farthest_fiv_gap));
    keep_certificate(*certificate, m);
  }
  write_fiv(options.output, baked.set, options.precision, common.force);

  const std::uint64_t bytes =
      std::uint64_t(options.turns) * table.values.size() * (options.precision == ExrPrecision::float32 ? 4 : 2);
  nlohmann::ordered_json result;
  result["output"] = options.output;
  result["samples"] = {table.size.x, table.size.y, table.size.z};
  result["hemispheres"] = table.hemispheres;
  result["table_bytes"] = bytes;
  result["file_bytes"] = std::filesystem::file_size(options.output);
  result["center_m"] = shortest(occluder.center_m, occluder.anchor_m);
  result["radius_m"] = shortest(table.radius_m);
  result["radii"] = nlohmann::ordered_json::array();
  for (const float r : table.radii) result["radii"].push_back(shortest(r));
  result["coverage"] = shortest(table.coverage);
  result.update(to_json(table.metadata));
  result["seconds"] = seconds;
  std::string human = fmt::format(
      "{}: {}{} x {} x {} samples, {} hemisphere{}, {} of {}, {:.1f} s\n"
      "bounding sphere of {:.4g} m around {:.4g} {:.4g} {:.4g}; spheres from {:.3g} to {:.3g} of "
      "its radius\n",
      options.output, options.turns > 1 ? fmt::format("{} turns, ", options.turns) : "", table.size.x, table.size.y,
      table.size.z, table.hemispheres, table.hemispheres == 1 ? "" : "s", format_bytes(bytes),
      name_of(options.precision), seconds, table.radius_m, center.x, center.y, center.z, table.radii.front(),
      table.radii.back());
  if (certificate) report_certificate(*certificate, result, human, loaded.warnings, common);
  result["warnings"] = loaded.warnings;
  print_result(common, result, human);
}

}  // namespace

void add_bake_fiv_command(Command bake, CommonOptions& common) {
  Command command = bake.add_subcommand(
      "fiv", "Bake what a moving mesh hides of an environment's light into an FIV occluder table (.exr)");
  auto options = std::make_shared<BakeFivOptions>();
  command.add_option("mesh", options->mesh, "Occluder: all triangles of a .gltf or .glb file")
      .required()
      .type_name("MESH");
  command.add_option("-o,--output", options->output, "Table to write, .exr").required().type_name("OUT.exr");
  add_environment_options(command, options->environment);
  add_scene_options(command, options->load);
  add_portable_option(command, options->load);
  command.get_option("--env").required();
  command.add_option("--samples", options->samples, "Samples in azimuth, polar angle and distance")
      .type_name("NA,NP,ND");
  command
      .add_option("--hemispheres", options->params.hemispheres,
                  "1: one vector per colour and sample, as published; 6: the vectors of six hemispheres, four\n"
                  "times the memory, right where the occluder reaches below a receiver's plane")
      .one_of({"1", "6"});
  command
      .add_option("--turns", options->turns,
                  "Tables of the mesh turned about +Y, evenly spaced over a whole turn: for occluders that turn, and\n"
                  "under a sky that turns; readers mix the two nearest. So many times the bytes and the time")
      .within(1, 360);
  add_contract_options(
      command, options->contract,
      "Error of E around the occluder to be reached, RMS ÷ mean unshadowed E, as 2% or 0.02",
      "the smallest table that does is baked, of --hemispheres 1 or 6 unless that is given, and of at most\n"
      "--samples (192,97,68 unless given)");
  command.add_choice("--precision", options->precision, "Of the file's numbers");
  command
      .add_option("--env-size", options->params.environment_size,
                  "Dim parts of the environment are merged to a cube of that many texels a face's edge")
      .within(1, 512);
  command.add_count("--parts", options->params.parts, 1, 1'000'000,
                    "Bright parts stay apart, as fine as the map is, until none carries more than 1 / PARTS of\n"
                    "all light; 1 merges them too");
  command.add_option("--farthest", options->params.farthest, "Outermost sphere, in radii of the bounding sphere")
      .within(1.5, 1000.0);
  command
      .add_option("--silhouette", options->params.silhouette_pixels,
                  "Pixels across the bounding sphere by which the mesh's outline is known; half as many for\n"
                  "dim parts of the environment, four times as many for the brightest")
      .within(8, 1024);
  command.footer(
      "The table serves the mesh wherever it is moved to, evenly scaled, under that environment, not turned;\n"
      "by --turns also turned about +Y.\n"
      "The same command gives the same bytes with any --threads.\n"
      "\nExamples:\n"
      "  ivory bake fiv bunny.glb --env sky.hdr -o bunny.exr --hemispheres 6\n"
      "  ivory render plaza.glb --env sky.hdr --object bunny.glb@1,0,2 --occluder bunny=bunny.exr --method fiv -o "
      "a.png");
  refuse_checkpoint_option(command);
  set_action(command, common, Output::file, [options, command, &common] { run_bake_fiv(*options, command, common); });
}

}  // namespace ivory
