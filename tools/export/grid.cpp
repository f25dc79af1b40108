#include "tools/export/grid.h"

#include <filesystem>
#include <iterator>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/export/probe_tetrahedra.h"
#include "grid/export/survey/survey.h"
#include "grid/export/survey/thin_walls.h"
#include "grid/io/export/godot.h"
#include "grid/io/export/nanovdb.h"
#include "grid/io/export/probe_volumes.h"
#include "grid/io/export/unity.h"
#include "grid/io/export/usd.h"
#include "grid/io/file.h"
#include "tools/cli/common.h"
#include "tools/export/export.h"
#include "tools/export/report.h"
#include "tools/export/scene_survey.h"
#include "tools/input/vdb/load.h"

namespace ivory {

namespace {

constexpr int loss_points = 200;
constexpr std::uint64_t loss_seed = 1;
constexpr int report_points = 10000;

// How each target reads: what its probes are, and from where.
struct ReaderKind {
  bool with_sh = false;
  bool can_rotate = false;
  float offset = 0;  // along the normal, in spacings
};

ReaderKind reader_of(ExportTarget target) {
  switch (target) {
    case ExportTarget::three_js:
      return {.with_sh = true, .offset = 0.5F};
    case ExportTarget::bevy:
    case ExportTarget::nanovdb:
      return {.can_rotate = true};
    case ExportTarget::godot:
    case ExportTarget::unity:
      return {.with_sh = true, .can_rotate = true};
    case ExportTarget::sh9:
    case ExportTarget::vrc:
      return {.with_sh = true};
    default:
      return {};
  }
}

const char* name_of_format(Ktx2Format format) {
  switch (format) {
    case Ktx2Format::rgba16f:
      return "half floats";
    case Ktx2Format::rgba32f:
      return "floats";
    case Ktx2Format::e5b9g9r9:
      return "E5B9G9R9";
  }
  return "";
}

ReaderReport make_report(const ExportOptions& options, const ExportFormat& format, IrradianceGrid& grid,
                         const ProbeVolume& volume, const ProbeReader& reader, const CommonOptions& common) {
  const V3f& h = volume.frame.spacing_m;
  const float apart_m = 2 * std::max({h.x, h.y, h.z});
  ReaderReport report{std::string(name_of(format.target)),
                      std::filesystem::path(options.asset).filename().string(),
                      grid.anchor_m,
                      !options.scene.empty(),
                      {},
                      measure_thin_walls(grid, volume, reader)};
  if (!report.by_rays) {
    report.survey = survey_planes(grid, reader, report_points, apart_m, loss_seed);
    return report;
  }
  // Probes stay about the anchor that they were made with.
  const V3d anchor_m = grid.anchor_m;
  const SceneInput input = load_scene_of_grid(options.scene, grid, common);
  const V3f moved(grid.anchor_m - anchor_m);
  const ProbeReader moved_reader = [&](const V3f& p, const V3f& n) { return reader(p + moved, n); };
  report.survey =
      survey_scene(*input.lit.scene, input.lit.intersector, grid, moved_reader, report_points, apart_m, loss_seed)
          .survey;
  for (ThinWall& wall : report.walls) wall.center -= moved;
  report.anchor_m = grid.anchor_m;
  return report;
}

// The file that is there, named by a stage: nothing is read or filled.
void export_usd(const ExportOptions& options, const CommonOptions& common) {
  if (options.voxel_size_m) throw UsageError("--to usd names the grid's own file: --voxel-size does not go with it");
  std::istringstream list(find_text(load_vdb_info(options.asset), "grids").value_or(""));
  const std::vector<std::string> names{std::istream_iterator<std::string>(list), {}};
  write_usd_volume(options.output, options.asset, names, common.force);
  const auto bytes = std::filesystem::file_size(options.output);
  print_result(
      common,
      {{"file", options.output},
       {"kind", "export"},
       {"target", "usd"},
       {"asset", "grid"},
       {"source", options.asset},
       {"fields", names},
       {"bytes", bytes}},
      fmt::format(
          "{}: a Volume of {} fields, which names {}\nits vectors lie in the grid's own frame, and walls are not "
          "filled: look-ups are the reader's\n",
          options.output, names.size(), options.asset));
}

}  // namespace

void export_grid(const ExportOptions& options, const ExportFormat& format, const CommonOptions& common) {
  if (format.target == ExportTarget::usd) {
    export_usd(options, common);
    return;
  }
  std::istringstream extensions{std::string(format.beside)};
  for (std::string extension; extensions >> extension;) check_output(beside(options.output, extension), common);
  IrradianceGrid grid = load_grid_vdb(options.asset);
  const ReaderKind kind = reader_of(format.target);
  const ProbeVolume volume = make_probe_volume(grid, {kind.can_rotate, kind.with_sh, options.voxel_size_m});
  std::optional<VolumeTetrahedra> tetrahedra;
  if (format.target == ExportTarget::godot || format.target == ExportTarget::unity)
    tetrahedra = volume_tetrahedra(volume);
  const ProbeReader reader =
      tetrahedra ? ProbeReader([&tetrahedra](const V3f& p, const V3f& n) { return irradiance(tap(*tetrahedra, p), n); })
      : format.target == ExportTarget::vrc ? vrc_reader(volume)
      : kind.with_sh                       ? sh9_reader(volume, kind.offset)
                                           : sides_reader(volume);
  ProbeExport about{std::string(name_of(format.target)), grid.light,
                    measure_reader(grid, volume, reader, kind.offset, loss_points, loss_seed), thin_walls(grid, volume),
                    grid.metadata};
  const Ktx2Format texels = options.texels == ExportTexels::rgb9e5 ? Ktx2Format::e5b9g9r9 : Ktx2Format::rgba16f;
  TextureResult written;
  std::optional<std::size_t> unity_probes;
  switch (format.target) {
    case ExportTarget::three_js:
      written = write_three_js_volume(options.output, volume, about, common.force);
      break;
    case ExportTarget::bevy:
      written = write_bevy_volume(options.output, volume, about, texels, common.force);
      break;
    case ExportTarget::godot:
      write_godot_probes(options.output, tetrahedra->probes, tetrahedra->sh, grid.metadata, common.force);
      written.format = Ktx2Format::rgba32f;
      break;
    case ExportTarget::unity:
      unity_probes = write_unity_probes(options.output, volume, common.force);
      written.format = Ktx2Format::rgba32f;
      break;
    case ExportTarget::vrc:
      written.scale = write_vrc_volume(options.output, volume, about, common.force);
      break;
    case ExportTarget::nanovdb:
      write_nanovdb(options.output, volume, common.force);
      written.format = Ktx2Format::rgba32f;
      break;
    case ExportTarget::sh9:
      written = write_sh9_volume(options.output, volume, about, common.force);
      break;
    default:
      written = write_sides_volume(options.output, volume, about, texels, common.force);
  }

  std::optional<ReaderReport> report;
  if (!options.report.empty()) {
    report = make_report(options, format, grid, volume, reader, common);
    write_file(options.report, report_html(*report), common.force);
  }

  Json result = probe_json(volume, about, options.output);
  result.erase("source");
  for (const char* key : {"format", "format_version", "ivory_version"}) result.erase(key);
  result["file"] = options.output;
  result["kind"] = "export";
  result["asset"] = "grid";
  result["source"] = options.asset;
  result["bytes"] = std::filesystem::file_size(options.output);
  result["texels"] = name_of_format(written.format);
  result["scale"] = written.scale;
  const V3i& n = volume.frame.size;
  const bool for_godot = format.target == ExportTarget::godot;
  if (for_godot) result["node_position_m"] = {grid.anchor_m.x, grid.anchor_m.y, grid.anchor_m.z};
  std::string text = fmt::format("{}: {} x {} x {} probes, {}, {}\n", options.output, n.x, n.y, n.z,
                                 name_of_format(written.format), format_bytes(result["bytes"]));
  std::string beside_names;
  extensions = std::istringstream{std::string(format.beside)};
  for (std::string extension; extensions >> extension;)
    beside_names += (beside_names.empty() ? "" : ", ") + beside(options.output, extension);
  if (!beside_names.empty()) text += "beside it: " + beside_names + "\n";
  if (unity_probes) {
    result["written_probes"] = *unity_probes;
    text += fmt::format("{} probes that are not dark; LightProbes.Tetrahedralize() joins them\n", *unity_probes);
  }
  if (for_godot) {
    text += fmt::format(
        "{} points, {} tetrahedra; for objects with gi_mode dynamic, each lit as its box's centre is; the "
        "node stands at {:g}, {:g}, {:g}\n",
        tetrahedra->probes.points.size(), tetrahedra->probes.tetrahedra.size(), grid.anchor_m.x, grid.anchor_m.y,
        grid.anchor_m.z);
  }
  if (volume.resampled) {
    text += fmt::format("resampled along the world's axes, {:.3g} x {:.3g} x {:.3g} m apart\n",
                        volume.frame.spacing_m.x, volume.frame.spacing_m.y, volume.frame.spacing_m.z);
  }
  text +=
      fmt::format("probes: {} know light, {} without light of their own were filled from those in front, {} are dark\n",
                  volume.count(ProbeState::measured), volume.count(ProbeState::filled), volume.count(ProbeState::dark));
  text += fmt::format(
      "this reader, off the grid's own look-ups, RMS of mean E: {:.2f} % in the open ({} points), {:.2f} % "
      "on surfaces ({})\n",
      100 * about.loss.in_the_open, about.loss.points_in_the_open, 100 * about.loss.on_surfaces,
      about.loss.points_on_surfaces);
  if (about.thin_walls > 0) {
    text += fmt::format(
        "{} pairs of lit neighbours do not see each other: walls thinner than a cell, through which this reader "
        "leaks\n",
        about.thin_walls);
  }
  if (report) {
    result["report"] = to_json(*report);
    result["report"]["file"] = options.report;
    text += report_text(*report);
  }
  if (written.scale != 1)
    text += fmt::format("stored is E / {:g}, and {:g} is the intensity\n", written.scale, written.scale);
  print_result(common, result, text);
}

}  // namespace ivory
