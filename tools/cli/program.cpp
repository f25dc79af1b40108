#include "tools/cli/program.h"

#include <algorithm>
#include <exception>
#include <iostream>
#include <new>

#include <CLI/CLI.hpp>

#include "grid/base/error.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/cli/host.h"
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

// The command line, with what its options are read into.
struct Program {
  Program();
  CommonOptions common;
  CLI::App app{
      "ivory bakes light: it traces photons through a glTF scene and leaves behind small assets that a\n"
      "renderer reads to light static and moving objects.",
      "ivory"};
};

Program::Program() {
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
  add_batch_command(program, common);
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
}

ProgramEnd parse(Program& program, int argc, const char* const* argv) {
  try {
    program.app.parse(argc, argv);
  } catch (const ParameterError& error) {
    return end(exit_usage, flag_of(program.app, error.parameter()) + ": " + error.cause());
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return end(exit_usage, std::string(error.what()) + "; --help explains");
    program.app.exit(error);  // prints --help or --version
    if (!std::cout.flush()) return end(exit_failed, "standard output: cannot be written; check where it goes");
  }
  return {};
}

ProgramEnd run(int argc, const char* const* argv, CommandHost* host) {
  try {
    Program program;
    program.common.host = host;
    return parse(program, argc, argv);
  } catch (const WorkBegins&) {
    return {};
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

std::string long_name(const CLI::Option& option) {
  return option.get_lnames().empty() ? option.get_name(/*positional=*/true) : option.get_lnames().front();
}

}  // namespace

ProgramEnd run_program(int argc, char** argv) { return run(argc, argv, nullptr); }

ProgramEnd run_hosted(const std::vector<std::string>& arguments, CommandHost& host) {
  std::vector<const char*> argv{"ivory"};
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  return run(int(argv.size()), argv.data(), &host);
}

std::vector<OptionFacts> options_of(const std::vector<std::string>& command) {
  const Program program;
  const CLI::App* app = &program.app;
  for (const std::string& name : command) app = app->get_subcommand(name);
  std::vector<OptionFacts> facts;
  for (const CLI::Option* option : app->get_options()) {
    if (option->get_group() == "Common options" || option == app->get_help_ptr()) continue;
    OptionFacts fact;
    fact.name = long_name(*option);
    fact.by_place = option->get_positional();
    fact.flag = option->get_items_expected_max() == 0;
    fact.repeated = option->get_items_expected_max() > 1;
    fact.required = option->get_required();
    fact.type_name = option->get_type_name();
    fact.description = option->get_description();
    for (const CLI::Option* other : option->get_excludes()) fact.excludes.push_back(long_name(*other));
    facts.push_back(std::move(fact));
  }
  return facts;
}

}  // namespace ivory
