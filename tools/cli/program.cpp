#include "tools/cli/program.h"

#include <algorithm>
#include <exception>
#include <iostream>
#include <new>

#include <CLI/CLI.hpp>

#include "grid/base/error.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/cli/interrupt.h"
#include "tracer/bake/checkpoint.h"

namespace ivory {

namespace {

constexpr int exit_failed = 1;
constexpr int exit_usage = 2;

// Scripts read one line, whatever a library put into its message.
ProgramEnd end(int exit_code, const std::string& message) { return {exit_code, in_one_line(message)}; }

// What sets a library's parameter: "--voxel-size" for voxel_size, where the command has such an option.
std::string flag_of(const CLI::App& app, const std::string& parameter) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  std::string flag = "--" + parameter;
  std::replace(flag.begin(), flag.end(), '_', '-');
  return command->get_option_no_throw(flag) != nullptr ? flag : parameter;
}

ProgramEnd run(int argc, char** argv) {
  CLI::App app(
      "ivory bakes light: it traces photons through a glTF scene and leaves behind small assets that a\n"
      "renderer reads to light static and moving objects.",
      "ivory");
  app.set_version_flag("--version", "ivory " IVORY_VERSION, "Print the version and exit");
  app.get_formatter()->column_width(34);
  app.require_subcommand(1);
  app.footer(
      "Examples:\n"
      "  ivory bake grid room.glb -o room.vdb\n"
      "  ivory render room.glb --method gather --grid room.vdb -o room.exr\n"
      "  ivory info room.vdb\n"
      "World: right-handed, +Y up, metres. Radiance in nits, irradiance in lux, linear Rec.709 colour.\n"
      "Exit codes: 0 done, 1 failed (one line on stderr says what, which file, what to do), 2 usage,\n"
      "130 and 143: stopped by Ctrl-C and SIGTERM, what was baked so far being kept (--checkpoint).\n"
      "'ivory COMMAND --help' explains a command.");

  // One line a command of commands.h.
  CommonOptions common;
  Command program(app);
  Command bake = program.add_subcommand("bake", "Bake light into an asset");
  bake.require_subcommand();
  add_bake_grid_command(bake, common);
  add_bake_cubemap_command(bake, common);
  add_bake_lightmap_command(bake, common);
  add_bake_lobes_command(bake, common);
  add_bake_spheres_command(bake, common);
  add_bake_difmap_command(bake, common);
  add_bake_sh9_command(bake, common);
  add_bake_fiv_command(bake, common);
  add_merge_command(program, common);
  add_mix_command(program, common);
  add_export_command(program, common);
  add_probe_command(program, common);
  add_points_command(program, common);
  add_render_command(program, common);
  add_view_command(program, common);
  add_compare_command(program, common);
  add_info_command(program, common);
  add_bench_command(program, common);
  add_chart_command(program, common);

  try {
    app.parse(argc, argv);
  } catch (const ParameterError& error) {
    return end(exit_usage, flag_of(app, error.parameter()) + ": " + error.cause());
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return end(exit_usage, std::string(error.what()) + "; --help explains");
    app.exit(error);  // prints --help or --version
    if (!std::cout.flush()) return end(exit_failed, "standard output: cannot be written; check where it goes");
  }
  return {};
}

}  // namespace

ProgramEnd run_program(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const UsageError& error) {
    return end(exit_usage, error.what());
  } catch (const BakeStopped& stopped) {
    return end(interrupted_exit_code(), stopped.what());
  } catch (const std::bad_alloc&) {
    return end(exit_failed, "not enough memory; ask for less (--resolution, --size), or free some and try again");
  } catch (const std::exception& error) {
    return end(exit_failed, error.what());
  }
}

}  // namespace ivory
