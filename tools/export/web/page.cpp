#include "tools/export/web/page.h"

#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/export/survey/thin_walls.h"
#include "grid/field/mix.h"
#include "grid/io/export/probe_volumes.h"
#include "grid/io/file.h"
#include "grid/io/sh9.h"
#include "tools/cli/common.h"
#include "tools/cli/target_error.h"
#include "tools/export/export.h"
#include "tools/export/report.h"
#include "tools/export/scene_survey.h"
#include "tools/export/web/page_table.h"
#include "tools/export/web/pending_folder.h"
#include "tools/export/web/scene_json.h"
#include "tools/export/web/three_package.h"
#include "tools/input/vdb/load.h"
#include "tracer/gltf/pack.h"

namespace ivory {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr float reader_offset = 0.5F;  // LightProbeGrid reads half a cell off the surface
constexpr int loss_points = 200;
constexpr int map_points = 20000;
constexpr std::size_t most_shadows = 6;  // as lamps.js has it

// What the page leaves out of the light.
std::vector<std::string> notes_of(const LitScene& lit, const IrradianceGrid& grid) {
  std::vector<std::string> notes;
  const DirectSources stored = direct_sources(grid.light);
  bool has_area = false;
  for (std::size_t light = 0; light < lit.lights.count(); ++light)
    has_area = has_area || (!lit.lights.is_punctual(light) && !lit.lights.is_environment(light));
  if (has_area && !stored.area)
    notes.emplace_back("lamps with a surface light nothing directly: bake the grid with --direct-of area for that");
  if (find_text(grid.metadata, "environment_hash") && !stored.sky)
    notes.emplace_back("the sky lights nothing directly: bake the grid with --direct-of sky for that");
  if (!stored.punctual && lit.scene->lights.size() > most_shadows)
    notes.push_back(fmt::format("only the first {} lamps cast shadows", most_shadows));
  for (const char* key : {"time_s", "without"}) {
    if (grid.metadata.contains(key)) {
      notes.emplace_back("the scene is shown as its file has it; the grid was baked with --time or --without");
      break;
    }
  }
  if (!grid.groups.empty())
    notes.emplace_back("where groups are dimmed, probes in walls are filled for each group by itself");
  return notes;
}

Json numbers_of(const IrradianceGrid& grid, const ProbeVolume& volume, const ProbeExport& about,
                const ReaderReport& report, const ThreePackage& three) {
  Json numbers = Json::array();
  const auto row = [&](const char* name, const std::string& value) { numbers.push_back({name, value}); };
  const V3i& n = volume.frame.size;
  const V3f& h = volume.frame.spacing_m;
  row("probes", fmt::format("{} × {} × {}", n.x, n.y, n.z));
  row("apart", fmt::format("{:.3g} × {:.3g} × {:.3g} m", h.x, h.y, h.z));
  row("know light", fmt::format("{}", volume.count(ProbeState::measured)));
  row("filled in walls", fmt::format("{}", volume.count(ProbeState::filled)));
  row("holds", std::string(name_of(grid.light)) + " light");
  if (const auto photons = find_int(grid.metadata, "photons")) row("photons", format_count(double(*photons)));
  if (const auto certificate = find_certificate(grid.metadata)) {
    row("error of the grid, certified", fmt::format("{} ({} to {})", format_share(certificate->error),
                                                    format_share(certificate->low), format_share(certificate->high)));
  }
  row("mean E on surfaces", fmt::format("{:.3g} lux", report.survey.mean_lux));
  row("this page, off the grid's guarded look-up",
      fmt::format("{:.2f} % on surfaces (RMS of mean E)", 100 * report.survey.rms));
  row("more than 10 % too bright", fmt::format("{:.2f} % of surfaces", 100 * report.survey.too_bright));
  row("more than 10 % too dark", fmt::format("{:.2f} % of surfaces", 100 * report.survey.too_dark));
  row("walls thinner than a cell", fmt::format("{} pairs of probes", about.thin_walls));
  row("baked by", "ivory " + find_text(grid.metadata, "version").value_or(IVORY_VERSION));
  row("shown by", "three.js " + three.version);
  return numbers;
}

// The light of each group alone.
Json write_groups(const std::string& folder, const IrradianceGrid& grid, const ProbeVolumeParams& params,
                  const ProbeExport& about) {
  Json list = Json::array();
  for (std::size_t i = 0; i < grid.groups.size(); ++i) {
    GroupFactors others;
    for (const GridGroup& group : grid.groups)
      if (group.name != grid.groups[i].name) others[group.name] = Rgb(0, 0, 0);
    const ProbeVolume volume = make_probe_volume(mix_groups(grid, others), params);
    const std::string name = "group" + std::to_string(i) + ".ktx2";
    write_three_js_atlas(folder + "/" + name, volume, about, false);
    list.push_back({{"name", grid.groups[i].name}, {"file", name}});
  }
  return list;
}

std::size_t bytes_in(const std::string& folder) {
  std::size_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) bytes += entry.file_size();
  return bytes;
}

}  // namespace

void export_web(const ExportOptions& options, const CommonOptions& common) {
  const ThreePackage three = find_three(options.three);
  PendingFolder folder(options.output, common.force);
  const std::string& to = folder.temporary();
  IrradianceGrid grid = load_grid_vdb(options.grid, /*with_groups=*/true);
  std::optional<Sh9Asset> sky;
  if (!options.sh9.empty()) sky = read_sh9(options.sh9);
  const SceneInput input = load_scene_of_grid(options.asset, grid, common);
  const LitScene& lit = input.lit;
  if (lit.scene->instances.empty()) throw Error(options.asset, "has nothing to show", "export it with its meshes");
  const PackedScene packed = pack_glb(options.asset);

  const ProbeVolumeParams params{.can_rotate = false, .with_sh = true, .voxel_size_m = options.voxel_size_m};
  const ProbeVolume volume = make_probe_volume(grid, params);
  const ProbeReader reader = sh9_reader(volume, reader_offset);
  const ProbeExport about{std::string(name_of(ExportTarget::web)), grid.light,
                          measure_reader(grid, volume, reader, reader_offset, loss_points, 1), thin_walls(grid, volume),
                          grid.metadata};
  const V3f& h = volume.frame.spacing_m;
  const float apart_m = 2 * std::max({h.x, h.y, h.z});
  const SceneSurvey surveyed = survey_scene(*lit.scene, lit.intersector, grid, reader, map_points, apart_m, /*seed=*/1);
  const ReaderReport report{std::string("the page"), fs::path(options.grid).filename().string(), grid.anchor_m, true,
                            surveyed.survey,         measure_thin_walls(grid, volume, reader)};

  write_three_js_volume(to + "/light.ktx2", volume, about, false);
  const Json groups = write_groups(to, grid, params, about);
  write_file(to + "/scene.glb", packed.bytes, false);
  const ErrorMap errors = make_error_map(surveyed.survey, grid.anchor_m);
  write_file(to + "/errors.bin", errors.bytes, false);
  for (const auto& [name, text] : page_files()) write_file(to + "/" + name, text, false);

  const DirectSources stored = direct_sources(grid.light);
  const std::size_t count = surveyed.survey.points.size();
  const float radius_m = lit.intersector.radius_m();
  const std::vector<std::string> notes = notes_of(lit, grid);
  Json page{{"generator", std::string("ivory ") + IVORY_VERSION},
            {"title", fs::path(options.asset).stem().string()},
            {"scale", find_number(grid.metadata, "scene_scale").value_or(1)},
            {"draco", packed.needs_draco},
            {"views", views_json(lit)},
            {"near_m", 2e-3 * double(radius_m)},
            {"far_m", 20 * double(radius_m)},
            {"exposure", page_exposure(lit, grid)},
            {"stored", {{"punctual", stored.punctual}, {"area", stored.area}, {"sky", stored.sky}}},
            {"lamps", lamps_json(*lit.scene, grid)},
            {"spheres", spheres_json(*lit.scene)},
            {"groups", groups},
            {"sky", nullptr},
            {"errors",
             {{"file", "errors.bin"},
              {"count", count},
              {"radius_m", 1.7 * std::sqrt(surveyed.area_m2 / (double(pi) * double(std::max<std::size_t>(count, 1))))},
              {"low", {errors.low.x, errors.low.y, errors.low.z}},
              {"extent", {errors.extent.x, errors.extent.y, errors.extent.z}},
              {"full", errors.full}}},
            {"numbers", numbers_of(grid, volume, about, report, three)},
            {"notes", notes}};
  if (sky) {
    page["sky"] = Json::array();
    for (const V3d& c : sky->sh.coefficients)
      for (int channel = 0; channel < 3; ++channel) page["sky"].push_back(c[channel]);
  }
  write_file(to + "/page.json", page.dump(1, ' ', false, Json::error_handler_t::replace) + "\n", false);

  const std::size_t bytes = bytes_in(to);
  std::vector<std::string> modules{"build/three.module.js", "examples/jsm/controls/OrbitControls.js",
                                   "examples/jsm/loaders/GLTFLoader.js", "examples/jsm/loaders/KTX2Loader.js",
                                   "examples/jsm/lighting/LightProbeGridWebGL.js"};
  if (packed.needs_draco) {
    for (const char* name :
         {"loaders/DRACOLoader.js", "libs/draco/gltf/draco_wasm_wrapper.js", "libs/draco/gltf/draco_decoder.wasm"})
      modules.push_back(std::string("examples/jsm/") + name);
  }
  const std::size_t three_bytes = copy_three(three, modules, to + "/three");
  folder.commit();

  Json result{{"file", options.output},
              {"kind", "export"},
              {"target", "web"},
              {"asset", "scene"},
              {"source", options.asset},
              {"grid", options.grid},
              {"bytes", bytes},
              {"three", three.version},
              {"three_bytes", three_bytes},
              {"exposure", page["exposure"]},
              {"probes",
               {{"measured", volume.count(ProbeState::measured)},
                {"filled", volume.count(ProbeState::filled)},
                {"dark", volume.count(ProbeState::dark)}}},
              {"loss", {{"in_the_open", about.loss.in_the_open}, {"on_surfaces", about.loss.on_surfaces}}},
              {"thin_walls", about.thin_walls},
              {"report", to_json(report)},
              {"notes", notes}};
  std::string text =
      fmt::format("{}: {}, and three.js {} of {}; serve it as it is: python3 -m http.server -d {}\n", options.output,
                  format_bytes(bytes), three.version, format_bytes(three_bytes), options.output);
  text += report_text(report);
  for (const std::string& note : notes) text += note + "\n";
  print_warnings(common, packed.warnings);
  print_result(common, result, text);
}

}  // namespace ivory
