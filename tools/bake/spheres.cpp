// ivory bake spheres: a mesh as a sphere set that casts its shadows.
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/cheapest.h"
#include "grid/base/error.h"
#include "grid/io/json.h"
#include "grid/io/sphere_set.h"
#include "tools/bake/asset_contract.h"
#include "tools/bake/checkpoint.h"
#include "tools/bake/facts.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/assumptions.h"
#include "tools/input/scene.h"
#include "tracer/bake/spheres/fit.h"
#include "tracer/bake/spheres/shadow_error.h"

namespace ivory {

namespace {

struct BakeSpheresOptions {
  std::string mesh;
  std::string output;
  SceneOptions load;
  int count = 64;
  int resolution = 0;
  AssetContract contract;
};

constexpr int most_spheres = 1024;  // that a set to an error has, unless --count says otherwise
constexpr int largest_count = 4096;
constexpr int refinements = 2;  // counts within a fifth of each other
// Receivers that the count is chosen at, and others that the result is judged at.
constexpr int pilot_receivers = 800;
constexpr int certificate_receivers = 1500;
constexpr std::uint64_t pilot_seed = 1;
constexpr std::uint64_t certificate_seed = 2;

// Rays of a half: what they leave uncertain is to stay well below the error.
int truth_rays(const AssetContract& contract) {
  int rays = 128;
  for (double target = contract.target.value_or(0.01); target < 0.01 && rays < 1024; target *= 1.5) rays *= 2;
  return rays;
}

struct Fitted {
  SphereFit fit;
  MeasuredError predicted;
};

// The smallest set of at most `most` spheres that meets the error. Few spheres are fitted fast, so that all sizes below
// cost about as much as the one that is kept.
Fitted choose_count(const Scene& scene, const SphereFitParams& params, const ShadowTruth& pilot, double target,
                    int most) {
  std::vector<int> ladder;
  for (int count = 1; count < most; count *= 4) ladder.push_back(count);
  ladder.push_back(most);
  std::map<int, Fitted> fits;
  const CheapestSetting setting = cheapest_setting(ladder, refinements, target, [&](int count) {
    SphereFitParams sized = params;
    sized.count = count;
    Fitted fitted{fit_spheres(scene, sized), {}};
    fitted.predicted = shadow_error(fitted.fit.set, pilot);
    return fits.emplace(count, std::move(fitted)).first->second.predicted;
  });
  return std::move(fits.at(setting.value));
}

BakePlan make_plan(const Fitted& fitted, double seconds) {
  BakePlan plan;
  const auto count = double(fitted.fit.set.spheres.size());
  plan.knobs["count"] = fitted.fit.set.spheres.size();
  plan.knobs["resolution"] = fitted.fit.resolution;
  plan.seconds = within_factor(1.1 * seconds, 1.6);
  plan.memory_bytes = within_factor(peak_memory_bytes(), 1.3);
  plan.file_bytes = within_factor(1300 + 48 * count, 1.8);
  plan.error = predicted_error(fitted.predicted);
  return plan;
}

void run(const BakeSpheresOptions& options, const Command& command, const CommonOptions& common) {
  const AssetContract& contract = options.contract;
  check_output(options.output, ".json", contract, common);
  MeshInput mesh = load_mesh_input(options.mesh, options.load, common);
  LoadedScene& loaded = mesh.loaded;
  print_warnings(common, loaded.warnings);

  SphereFitParams params;
  params.count = options.count;
  params.resolution = options.resolution;
  Progress progress(common, "fitting", "steps");
  params.progress = [&](double fraction) { progress.update(std::uint64_t(fraction * 1000), 1000); };
  const auto start = std::chrono::steady_clock::now();
  const auto trace_truth = [&](int receivers, std::uint64_t seed) {
    return trace_shadow_truth(loaded.scene, {receivers, truth_rays(contract), seed});
  };
  Fitted fitted;
  if (contract.target) {
    const int most = command.get_option("--count").given() ? options.count : most_spheres;
    params.progress = {};  // of how many fits is not known
    fitted = choose_count(loaded.scene, params, trace_truth(pilot_receivers, pilot_seed), *contract.target, most);
  } else {
    fitted.fit = fit_spheres(loaded.scene, params);
    if (contract.dry_run) fitted.predicted = shadow_error(fitted.fit.set, trace_truth(pilot_receivers, pilot_seed));
  }
  SphereFit& fit = fitted.fit;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (contract.dry_run) {
    print_plan(options.output, make_plan(fitted, seconds), contract, loaded.warnings, common);
    return;
  }

  const SphereFitErrors& e = fit.errors;
  Metadata& m = fit.set.metadata =
      sphere_facts(mesh, fit, contract.target ? std::nullopt : std::optional(options.count));
  std::optional<Certificate> certificate;
  if (contract.measures()) {
    certificate = make_certificate(
        shadow_error(fit.set, trace_truth(certificate_receivers, certificate_seed)), contract,
        fmt::format("hidden share of a lamp of half-angle {:g} rad behind the mesh at {} receivers, {:g} to {:g} "
                    "bounding radii around, against rays to the mesh; RMS ÷ unshadowed E",
                    shadow_lamp_half_angle_rad, certificate_receivers, nearest_shadow_receiver,
                    farthest_shadow_receiver));
    keep_certificate(*certificate, m);
  }
  write_spheres(options.output, fit.set, common.force);

  nlohmann::ordered_json result;
  result["output"] = options.output;
  result.update(to_json(m));
  result["seconds"] = seconds;
  std::string human = fmt::format("{}: {} spheres, {} voxels along the longest side, {:.2f} s\n", options.output,
                                  fit.set.spheres.size(), fit.resolution, seconds);
  human += fmt::format("volume: {:.2f} % of the {} outside the mesh, {:.2f} % uncovered\n", 100 * e.volume_outside,
                       fit.solid ? "mesh's" : "bounding sphere's", 100 * e.volume_uncovered);
  human += fmt::format(
      "surface: {:.2f} % of it farther than 2 % of the bounding radius beyond the spheres, mean distance {:.2f} %, "
      "farthest {:.2f} %\n",
      100 * e.surface_uncovered, 100 * e.surface_mean, 100 * e.surface_farthest);
  if (!fit.solid) human += "the mesh encloses next to no volume: spheres cover its surface\n";
  if (certificate) report_certificate(*certificate, result, human, loaded.warnings, common);
  result["warnings"] = loaded.warnings;
  print_result(common, result, human);
}

}  // namespace

void add_bake_spheres_command(Command bake, CommonOptions& common) {
  Command command = bake.add_subcommand("spheres", "A mesh as a set of spheres, which casts its shadows");
  auto options = std::make_shared<BakeSpheresOptions>();
  command.add_option("mesh", options->mesh, "Mesh: .gltf or .glb, all of its scene, in its world space")
      .required()
      .type_name("MESH");
  command.add_option("-o,--output", options->output, "Sphere set to write").required().type_name("OUT.json");
  command.add_count("--count", options->count, 1, largest_count, "Spheres, 4096 at most");
  add_contract_options(command, options->contract,
                       "Error of the hidden share of a lamp to be reached, RMS, as 2% or 0.02",
                       "the fewest spheres that do are fitted, of at most --count (1024 unless given)");
  command.add_option("--resolution", options->resolution, "Voxels along the longest side [48 to 160 by --count]")
      .within(16, 192);
  add_scene_options(command, options->load);
  command.footer(
      "The volume that the spheres add and the volume that they leave out are made as small as can be, in sum.\n"
      "\nExample:\n"
      "  ivory bake spheres bunny.glb -o bunny.json --count 64");
  refuse_checkpoint_option(command);
  set_action(command, common, Output::file, [options, command, &common] { run(*options, command, common); });
}

}  // namespace ivory
