// ivory export: baked assets as the files that other engines read.
#include "tools/export/export.h"

#include <memory>

#include "grid/base/error.h"
#include "grid/io/file.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/export/distant.h"
#include "tools/export/grid.h"
#include "tools/export/web/page.h"
#include "tools/input/file_kind.h"

namespace ivory {

namespace {

ExportAsset asset_of(const std::string& path, FileKind kind) {
  switch (kind) {
    case FileKind::sh9:
    case FileKind::difmap:
      return ExportAsset::distant;
    case FileKind::grid:
      return ExportAsset::grid;
    case FileKind::scene:
      return ExportAsset::scene;
    case FileKind::image:
      throw Error(path, "is not baked", "give what 'ivory bake' has written: a grid, SH9 or DifMap");
    default:
      throw Error(path, "is of kind " + std::string(name_of(kind)) + ", which no target takes",
                  "give a grid, SH9 or DifMap");
  }
}

void run_web(const ExportOptions& options, const Command& command, const CommonOptions& common) {
  if (options.grid.empty()) throw UsageError("--to web shows a scene by its baked light: give --grid GRID.vdb");
  for (const char* name : {"--scene", "--texels", "--report"})
    if (command.get_option(name).given()) throw UsageError(std::string(name) + " does not serve --to web");
  export_web(options, common);
}

void run_export(const ExportOptions& options, const Command& command, const CommonOptions& common) {
  const FileKind kind = file_kind(options.asset);
  const ExportAsset asset = asset_of(options.asset, kind);
  const bool for_web = options.target == ExportTarget::web;
  if (asset == ExportAsset::scene && !for_web)
    throw Error(options.asset, "is not baked", "give what 'ivory bake' has written: a grid, SH9 or DifMap");
  if (asset != ExportAsset::scene && for_web)
    throw UsageError("--to web shows a scene: ivory export SCENE --grid GRID.vdb --to web");
  const std::string extension = options.output.ends_with('/') ? "" : lower_extension(options.output);
  const ExportFormat& format = export_format(options.target, asset, extension);
  if (for_web) {
    run_web(options, command, common);
    return;
  }
  for (const char* name : {"--grid", "--sh9", "--three"})
    if (command.get_option(name).given()) throw UsageError(std::string(name) + " serves --to web only");
  check_output(options.output, common);
  if (!options.report.empty()) check_output(options.report, ".html", common);
  if (format.target == ExportTarget::gltf) {
    if (options.scene.empty()) throw UsageError("--to gltf puts the light into a scene's file: give --scene");
    if (lower_extension(options.scene) != format.extension)
      throw UsageError("--output and --scene are of one kind: both .gltf or both .glb");
  } else if (!options.scene.empty() && options.report.empty()) {
    throw UsageError("--scene serves --to gltf, and --report of grids");
  }
  const bool of_grid = format.asset == ExportAsset::grid;
  if (!options.report.empty() && (!of_grid || format.target == ExportTarget::usd))
    throw UsageError("--report is of grids for readers that ivory knows the look-up of");
  if (!of_grid && options.voxel_size_m) throw UsageError("--voxel-size serves grids only");
  const bool has_texels = of_grid && (format.target == ExportTarget::bevy || format.target == ExportTarget::sides);
  if (!has_texels && command.get_option("--texels").given())
    throw UsageError("--texels serves grids for bevy and sides only");
  if (of_grid) {
    export_grid(options, format, common);
  } else {
    export_distant(options, kind, format, common);
  }
}

}  // namespace

void add_export_command(Command app, CommonOptions& common) {
  Command command = app.add_subcommand("export", "Write a baked asset as another engine reads it");
  auto options = std::make_shared<ExportOptions>();
  command.add_option("asset", options->asset, "SH9 (.json), DifMap (.exr), grid (.vdb), or a scene for --to web")
      .required()
      .type_name("ASSET");
  command.add_choice("--to", options->target, "Who is to read it").required().default_str("").type_name("TARGET");
  command.add_option("-o,--output", options->output, "File to write, whose extension is the target's; a folder for web")
      .required()
      .type_name("OUT");
  command
      .add_option("--scene", options->scene,
                  "For --to gltf: the scene that the light is put into.\n"
                  "For --report: the scene that the grid was baked from, to look at all its surfaces")
      .type_name("SCENE.gltf|glb");
  command
      .add_option("--voxel-size", options->voxel_size_m,
                  "For grids: metres between probes, which then fill the box around the grid along the world's axes")
      .positive()
      .type_name("M");
  command
      .add_option("--report", options->report,
                  "For grids: a page that says what the reader will show: where it is off, and walls that leak")
      .type_name("REPORT.html");
  command.add_option("--grid", options->grid, "For --to web: the scene's grid").type_name("GRID.vdb");
  command.add_option("--sh9", options->sh9, "For --to web: light of the surroundings, shown while the grid is off")
      .type_name("SH9.json");
  command
      .add_option("--three", options->three,
                  "For --to web: folder of the npm package three [node_modules/three here or above]")
      .type_name("FOLDER");
  command.add_choice("--texels", options->texels,
                     "For grids to bevy and sides: half floats, or 9 bits a channel with a shared exponent");
  command.footer("Targets of SH9 and DifMaps:\n" + export_format_lines(ExportAsset::distant) + "Targets of grids:\n" +
                 export_format_lines(ExportAsset::grid) + "Targets of scenes:\n" +
                 export_format_lines(ExportAsset::scene) +
                 "docs/export.md says how each is loaded, and what is lost.\n"
                 "\nExamples:\n"
                 "  ivory export sky.json --to three.js -o sky_probe.json\n"
                 "  ivory export sky.json --to gltf --scene room.glb -o lit_room.glb\n"
                 "  ivory export room.vdb --to three.js -o room.ktx2\n"
                 "  ivory export house.vdb --to bevy -o house.ktx2 --voxel-size 0.5\n"
                 "  ivory export house.vdb --to godot -o house.tres --scene house.glb --report house.html\n"
                 "  ivory export house.glb --grid house.vdb --to web -o page/");
  set_action(command, common, Output::file, [options, command, &common] { run_export(*options, command, common); });
}

}  // namespace ivory
