// ivory bake lightmap: E per texel of a scene's own charts.
#include <chrono>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/io/export/lightmap_texture.h"
#include "grid/io/file.h"
#include "grid/io/json.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/assumptions.h"
#include "tools/input/grid.h"
#include "tools/input/scene.h"
#include "tracer/bake/lightmap/baker.h"
#include "tracer/image/file.h"

namespace ivory {

namespace {

constexpr int lightmap_uv_set = 1;
constexpr const char* texture_extension = ".ktx2";

struct BakeLightmapOptions {
  std::string scene;
  std::vector<std::string> outputs;
  SceneOptions load;
  EnvironmentChoice environment;
  std::shared_ptr<GridInputOptions> grid;
  Imath::V2i size{1024, 1024};
  LightmapParams bake;
};

void check_outputs(const BakeLightmapOptions& options, const CommonOptions& common) {
  for (const std::string& output : options.outputs) {
    check_output(output, common);
    const std::string extension = lower_extension(output);
    if (extension != texture_extension && extension != ".exr")
      throw UsageError("--output: a lightmap is written as .exr or .ktx2, not as " + output);
  }
}

void write_outputs(const BakeLightmapOptions& options, const Lightmap& map, const Metadata& metadata,
                   const CommonOptions& common) {
  for (const std::string& output : options.outputs) {
    if (lower_extension(output) == texture_extension) {
      const std::string text = to_json(metadata).dump(-1, ' ', false, Json::error_handler_t::replace);
      write_lightmap_texture(output, map.width, map.height, map.e, {{"ivory", text}}, common.force);
      continue;
    }
    Film film;
    film.width = map.width;
    film.height = map.height;
    film.pixels = map.e;
    write_image(output, film, 0, metadata, common.force);
  }
}

void run_bake_lightmap(const BakeLightmapOptions& options, const CommonOptions& common) {
  if (options.grid->grid.empty()) throw UsageError("bake lightmap gathers light through a grid: give --grid GRID.vdb");
  check_outputs(options, common);
  SceneOptions load = options.load;
  load.load.uv_sets = {lightmap_uv_set};
  const SceneInput input = load_scene_input(options.scene, load, options.environment, common);
  const LitScene& lit = input.lit;
  if (lit.lights.empty()) print_note(common, fmt::format("warning: nothing in {} emits light", options.scene));
  const Charts charts = make_charts(*lit.scene, lightmap_uv_set, options.size.x, options.size.y);
  const IrradianceGrid grid = load_grid(*options.grid, input, common);
  LookupTally tally;
  const GridLight light{&grid, options.grid->lookup, &tally};

  const auto start = std::chrono::steady_clock::now();
  LightmapParams params = options.bake;
  params.threads = thread_count(common);
  Progress progress(common, "baking", "texels");
  const std::uint64_t texels = charts.texels.size();
  params.progress = [&](double fraction) { progress.update(std::uint64_t(fraction * double(texels)), texels); };
  const Lightmap map = bake_lightmap(lit, indirect_light(lit, light), charts, params);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const std::size_t baked = map.count(TexelState::baked);
  const std::size_t buried = map.count(TexelState::buried);
  V3d mean(0, 0, 0);
  for (std::size_t i = 0; i < map.e.size(); ++i)
    if (map.states[i] == TexelState::baked) mean += V3d(map.e[i]) / double(std::max<std::size_t>(baked, 1));
  Metadata m = input.origin;
  m["version"] = std::string(IVORY_VERSION);
  m["method"] = std::string("lightmap");
  describe(*options.grid, m);
  describe(tally, m);
  m["samples"] = std::int64_t(params.samples);
  m["gather_rays"] = std::int64_t(params.gather_rays);
  m["seed"] = std::int64_t(params.seed);
  m["light"] = std::string(params.indirect_only ? "indirect" : "all");
  m["uv_set"] = std::int64_t(lightmap_uv_set);
  m["units"] = std::string("lux");
  std::vector<std::string> warnings = doubts_about(tally, *options.grid);
  if (baked == 0) warnings.emplace_back("no texel lies on a surface that light can reach");
  keep_assumptions(m, input.warnings);
  print_warnings(common, warnings);
  write_outputs(options, map, m, common);

  nlohmann::ordered_json result{{"output", options.outputs.front()}, {"outputs", options.outputs}};
  result["width"] = map.width;
  result["height"] = map.height;
  result.update(to_json(m));
  result["texels"] = {{"baked", baked},
                      {"buried", buried},
                      {"dilated", map.count(TexelState::dilated)},
                      {"empty", map.count(TexelState::empty)}};
  result["mean_lux"] = {mean.x, mean.y, mean.z};
  result["seconds"] = seconds;
  std::vector<std::string> all = input.warnings;
  all.insert(all.end(), warnings.begin(), warnings.end());
  result["warnings"] = all;
  print_result(common, result,
               fmt::format("{}: {} x {}, {} texels baked, {} buried in solids, {} around charts, mean {:.4g} {:.4g} "
                           "{:.4g} lux, {:.2f} s\n",
                           fmt::join(options.outputs, ", "), map.width, map.height, baked, buried,
                           map.count(TexelState::dilated), mean.x, mean.y, mean.z, seconds));
}

}  // namespace

void add_bake_lightmap_command(Command bake, CommonOptions& common) {
  Command command = bake.add_subcommand(
      "lightmap", "Bake E into a texture over the scene's own charts (TEXCOORD_1), by final gather");
  auto options = std::make_shared<BakeLightmapOptions>();
  command.add_option("scene", options->scene, "Scene: .gltf or .glb, metres, +Y up, unwrapped in TEXCOORD_1")
      .required()
      .type_name("SCENE");
  command.add_option("-o,--output", options->outputs, "Lightmap to write: .exr or .ktx2; may be repeated")
      .repeated()
      .required()
      .type_name("OUT");
  command.add_image_size("--size", options->size, "Texels");
  command.add_count("--samples", options->bake.samples, 1, 1'000'000,
                    "Places in a texel, with a sample of direct light each");
  command.add_count("--gather", options->bake.gather_rays, 0, 65536,
                    "Gather rays a place; 0 reads the grid at the texel itself");
  command.add_count("--seed", options->bake.seed, "Seed of the random numbers");
  command.add_count("--dilate", options->bake.dilate, 0, 1024, "Texels that charts are grown by, against dark seams");
  command.add_flag("--indirect-only", options->bake.indirect_only,
                   "Only light with a surface between its source and the texel, for engines that draw the lamps");
  add_environment_options(command, options->environment);
  add_scene_options(command, options->load);
  options->grid = add_grid_options(command, "Baked grid of indirect light");
  command.footer(
      "ivory unwraps nothing: charts that overlap, or are missing, are an error that names them.\n"
      "A texel holds E in lux at the smooth normal of its surface's front side, not divided by pi.\n"
      "The same command gives the same bytes with any --threads.\n"
      "\nExamples:\n"
      "  ivory bake lightmap room.glb --grid room.vdb -o room.exr\n"
      "  ivory bake lightmap room.glb --grid room.vdb --indirect-only --size 2048x2048 -o room.ktx2");
  set_action(command, common, Output::file, [options, &common] { run_bake_lightmap(*options, common); });
}

}  // namespace ivory
