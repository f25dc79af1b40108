// ivory bake difmap: an environment map's irradiance for every normal, as a cube map.
#include "grid/io/difmap.h"

#include <chrono>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/env/irradiance.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/environment.h"

namespace ivory {

namespace {

struct BakeDifmapOptions {
  EnvironmentChoice environment;
  std::string output;
  int size = 64;
};

void run_bake_difmap(const BakeDifmapOptions& options, const CommonOptions& common) {
  check_output(options.output, ".exr", common);
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  EnvironmentInput input = load_environment_input(options.environment);
  const auto loaded = Clock::now();
  print_warnings(common, input.warnings);
  const IrradianceTree tree = make_irradiance_tree(input.image);
  IrradianceMap baked = bake_irradiance(tree, options.size);
  const double bake_seconds = std::chrono::duration<double>(Clock::now() - loaded).count();

  const V3d total = tree.total();
  double bound = 0;
  for (int c = 0; c < 3; ++c)
    if (total[c] > 0) bound = std::max(bound, baked.error_bound[c] / total[c]);
  const Sh9Error sh9 = sh9_error(sh9_from_moments(radiance_moments(input.image)), baked.e, total);

  DifMap map{std::move(baked.e), std::move(input.origin)};
  map.metadata["method"] = std::string("difmap");
  map.metadata["size"] = std::int64_t(options.size);
  map.metadata["error_bound"] = bound;
  map.metadata["sh9_average_error"] = sh9.average;
  map.metadata["sh9_maximum_error"] = sh9.maximum;
  write_difmap(options.output, map, common.force);

  print_result(
      common,
      {{"file", options.output},
       {"kind", "difmap"},
       {"layout", name_of(input.image.layout)},
       {"size", options.size},
       {"total_radiance", {total.x, total.y, total.z}},
       {"error_bound", bound},
       {"sh9_average_error", sh9.average},
       {"sh9_maximum_error", sh9.maximum},
       {"sh9_average_error_of_mean_irradiance", sh9.average_of_mean_e()},
       {"sh9_maximum_error_of_mean_irradiance", sh9.maximum_of_mean_e()},
       {"read_seconds", std::chrono::duration<double>(loaded - start).count()},
       {"bake_seconds", bake_seconds},
       {"warnings", input.warnings}},
      fmt::format(
          "{}: 6 x {} x {} texels of E in lux, {:.2f} s\n"
          "error below {:.2g} % of the light of the whole sphere at the texels' normals\n"
          "SH9 instead would be wrong by {:.2f} % on average, {:.2f} % at most ({:.1f} % and {:.1f} % of the mean "
          "E)\n",
          options.output, options.size, options.size, bake_seconds, 100 * bound, 100 * sh9.average, 100 * sh9.maximum,
          100 * sh9.average_of_mean_e(), 100 * sh9.maximum_of_mean_e()));
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
  command.add_option("--size", options->size, "Texels along an edge of a face").within(1, 1024);
  command.footer(
      "--json: read_seconds is the time to load the map, bake_seconds that of its irradiance with the bound on its\n"
      "error; the rest of the command's time goes into comparing SH9 with it and writing the file.\n"
      "\nExamples:\n"
      "  ivory bake difmap sky.exr -o sky_difmap.exr\n"
      "  ivory bake difmap probe.hdr -o probe_difmap.exr --layout angular --size 32");
  set_action(command, common, Output::file, [options, &common] { run_bake_difmap(*options, common); });
}

}  // namespace ivory
