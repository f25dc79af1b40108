// ivory: the command line. Exit codes: 0 done, 1 failed, 2 usage.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"

namespace {

constexpr int exit_failed = 1;
constexpr int exit_usage = 2;

// Scripts read one line, whatever a library put into its message.
void print_error(std::string message) {
  for (char& c : message) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  fmt::print(stderr, "ivory: {}\n", message);
}

// What sets a library's parameter: "--voxel-size" for voxel_size, where the command has such an option.
std::string flag_of(const CLI::App& app, const std::string& parameter) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  std::string flag = "--" + parameter;
  std::replace(flag.begin(), flag.end(), '_', '-');
  return command->get_option_no_throw(flag) != nullptr ? flag : parameter;
}

int run(int argc, char** argv) {
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
      "Exit codes: 0 done, 1 failed (one line on stderr says what, which file, what to do), 2 usage.\n"
      "'ivory COMMAND --help' explains a command.");

  // One line a command of commands.h.
  ivory::CommonOptions common;
  ivory::Command program(app);
  ivory::Command bake = program.add_subcommand("bake", "Bake light into an asset");
  bake.require_subcommand();
  ivory::add_bake_grid_command(bake, common);
  ivory::add_bake_cubemap_command(bake, common);
  ivory::add_bake_lobes_command(bake, common);
  ivory::add_bake_spheres_command(bake, common);
  ivory::add_bake_difmap_command(bake, common);
  ivory::add_bake_sh9_command(bake, common);
  ivory::add_bake_fiv_command(bake, common);
  ivory::add_merge_command(program, common);
  ivory::add_probe_command(program, common);
  ivory::add_render_command(program, common);
  ivory::add_view_command(program, common);
  ivory::add_compare_command(program, common);
  ivory::add_info_command(program, common);
  ivory::add_bench_command(program, common);
  ivory::add_chart_command(program, common);

  try {
    app.parse(argc, argv);
  } catch (const ivory::ParameterError& error) {
    print_error(flag_of(app, error.parameter()) + ": " + error.cause());
    return exit_usage;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    print_error(std::string(error.what()) + "; --help explains");
    return exit_usage;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const ivory::UsageError& error) {
    print_error(error.what());
    return exit_usage;
  } catch (const std::bad_alloc&) {
    print_error("not enough memory; ask for less (--resolution, --size), or free some and try again");
  } catch (const std::exception& error) {
    print_error(error.what());
  }
  return exit_failed;
}
