// ivory bake difmap: an environment map's irradiance for every normal, as a cube map.
#include "grid/io/difmap.h"

#include <chrono>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/cheapest.h"
#include "grid/base/error.h"
#include "grid/env/irradiance.h"
#include "grid/env/irradiance/error.h"
#include "tools/bake/asset_contract.h"
#include "tools/bake/checkpoint.h"
#include "tools/bake/facts.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/environment.h"

namespace ivory {

namespace {

struct BakeDifmapOptions {
  EnvironmentChoice environment;
  std::string output;
  int size = 64;
  AssetContract contract;
};

constexpr int largest_size = 1024;
// Normals that sizes are chosen at, and others that the result is judged at.
constexpr int pilot_normals = 800;
constexpr int certificate_normals = 500;
constexpr std::uint64_t pilot_seed = 1;
constexpr std::uint64_t certificate_seed = 2;
constexpr int refinements = 3;  // sizes within a twelfth of each other

// The smallest map that meets the error, of at most `most` texels along an edge.
CheapestSetting choose_size(const IrradianceTree& tree, double target, int most) {
  const IrradianceTruth pilot = make_irradiance_truth(tree, pilot_normals, pilot_seed);
  std::vector<int> ladder;
  for (int size = 1; size < most; size *= 2) ladder.push_back(size);
  ladder.push_back(most);
  return cheapest_setting(ladder, refinements, target,
                          [&](int size) { return predicted_difmap_error(tree, size, pilot); });
}

// Irradiance at some texels tells what all of them take.
BakePlan make_plan(const IrradianceTree& tree, const CheapestSetting& setting) {
  constexpr int timed = 1000;
  const auto start = std::chrono::steady_clock::now();
  make_irradiance_truth(tree, timed, pilot_seed);
  const double each = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / timed;
  const double texels = 6.0 * setting.value * setting.value;
  BakePlan plan;
  plan.knobs["size"] = setting.value;
  plan.seconds = within_factor(each * (texels + certificate_normals), 2);
  plan.memory_bytes = within_factor(peak_memory_bytes() + 40 * texels, 1.3);
  // Floats of smooth faces are packed to a half up to nine tenths.
  plan.file_bytes = {0.4 * texels * 12, 0.75 * texels * 12, texels * 12 + 4096};
  plan.error = predicted_error(setting.predicted);
  return plan;
}

void run_bake_difmap(const BakeDifmapOptions& options, const Command& command, const CommonOptions& common) {
  const AssetContract& contract = options.contract;
  check_output(options.output, ".exr", contract, common);
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  EnvironmentInput input = load_environment_input(options.environment, common);
  const auto loaded = Clock::now();
  print_warnings(common, input.warnings);
  const IrradianceTree tree = make_irradiance_tree(input.image);
  int size = options.size;
  if (contract.target || contract.dry_run) {
    CheapestSetting setting;
    if (contract.target) {
      const bool bounded = command.get_option("--size").given();
      setting = choose_size(tree, *contract.target, bounded ? options.size : largest_size);
    } else {
      setting = {size, predicted_difmap_error(tree, size, make_irradiance_truth(tree, pilot_normals, pilot_seed)),
                 true};
    }
    size = setting.value;
    if (contract.dry_run) {
      print_plan(options.output, make_plan(tree, setting), contract, input.warnings, common);
      return;
    }
  }
  IrradianceMap baked = bake_irradiance(tree, size);
  const double bake_seconds = std::chrono::duration<double>(Clock::now() - loaded).count();

  const V3d total = tree.total();
  const Sh9Error sh9 = sh9_error(sh9_from_moments(radiance_moments(input.image)), baked.e, total);

  std::optional<Certificate> certificate;
  if (contract.measures()) {
    certificate = make_certificate(
        difmap_error(baked.e, sum_irradiance_truth(input.image, certificate_normals, certificate_seed)), contract,
        irradiance_measure(certificate_normals));
  }
  DifMap map = make_difmap(std::move(baked), total, sh9, std::move(input.origin));
  if (certificate) keep_certificate(*certificate, map.metadata);
  const double bound = std::get<double>(map.metadata.at("error_bound"));
  write_difmap(options.output, map, common.force);

  nlohmann::ordered_json result{{"file", options.output},
                                {"kind", "difmap"},
                                {"layout", name_of(input.image.layout)},
                                {"size", size},
                                {"total_radiance", {total.x, total.y, total.z}},
                                {"error_bound", bound},
                                {"sh9_average_error", sh9.average},
                                {"sh9_maximum_error", sh9.maximum},
                                {"sh9_average_error_of_mean_irradiance", sh9.average_of_mean_e()},
                                {"sh9_maximum_error_of_mean_irradiance", sh9.maximum_of_mean_e()},
                                {"read_seconds", std::chrono::duration<double>(loaded - start).count()},
                                {"bake_seconds", bake_seconds}};
  std::string human = fmt::format(
      "{}: 6 x {} x {} texels of E in lux, {:.2f} s\n"
      "error below {:.2g} % of the light of the whole sphere at the texels' normals\n"
      "SH9 instead would be wrong by {:.2f} % on average, {:.2f} % at most ({:.1f} % and {:.1f} % of the mean "
      "E)\n",
      options.output, size, size, bake_seconds, 100 * bound, 100 * sh9.average, 100 * sh9.maximum,
      100 * sh9.average_of_mean_e(), 100 * sh9.maximum_of_mean_e());
  if (certificate) report_certificate(*certificate, result, human, input.warnings, common);
  result["warnings"] = input.warnings;
  print_result(common, result, human);
}

}  // namespace

void add_bake_difmap_command(Command bake, CommonOptions& common) {
  Command command =
      bake.add_subcommand("difmap", "Irradiance of an environment map for every normal, a cube map (.exr)");
  auto options = std::make_shared<BakeDifmapOptions>();
  command.add_option("environment", options->environment.path, "Environment map in nits: .exr, .hdr or other image")
      .required()
      .type_name("ENV");
  command.add_option("-o,--output", options->output, "Cube map to write, .exr: six faces with envmap = cube")
      .required()
      .type_name("OUT.exr");
  add_layout_option(command, options->environment);
  command.add_option("--size", options->size, "Texels along an edge of a face").within(1, largest_size);
  add_contract_options(command, options->contract, "Error of E to be reached, RMS over normals ÷ mean E, as 2% or 0.02",
                       "the smallest map that does is baked, of at most --size texels where that is given");
  command.footer(
      "--json: read_seconds is the time to load the map, bake_seconds that of its irradiance with the bound on its\n"
      "error; the rest of the command's time goes into comparing SH9 with it and writing the file.\n"
      "\nExamples:\n"
      "  ivory bake difmap sky.exr -o sky_difmap.exr\n"
      "  ivory bake difmap probe.hdr -o probe_difmap.exr --layout angular --size 32");
  refuse_checkpoint_option(command);
  set_action(command, common, Output::file,
             [options, command, &common] { run_bake_difmap(*options, command, common); });
}

}  // namespace ivory
