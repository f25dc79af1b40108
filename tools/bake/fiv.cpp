// ivory bake fiv: an occluder table of a mesh under an environment.
#include "grid/io/fiv.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/env/environment_image.h"
#include "grid/env/latlong_map.h"
#include "grid/io/environment.h"
#include "grid/io/json.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/assumptions.h"
#include "tools/input/environment.h"
#include "tools/input/scene.h"
#include "tracer/bake/fiv/baker.h"

namespace ivory {

namespace {

struct BakeFivOptions {
  std::string mesh;
  std::string output;
  SceneOptions load;
  EnvironmentChoice environment;
  std::string samples = "128,65,30";
  ExrPrecision precision = ExrPrecision::float32;
  FivParams params;
};

FivParams params_of(const BakeFivOptions& options) {
  FivParams params = options.params;
  params.samples = parse_size3("--samples", options.samples, 2);
  if (params.samples.x < 3) throw UsageError("--samples: at least 3 azimuths are needed");
  return params;
}

void check_size(const BakeFivOptions& options, const FivParams& params) {
  const double samples = double(params.samples.x) * double(params.samples.y) * double(params.samples.z);
  const double numbers = 3 * fiv_function_count(params.hemispheres);
  // The table, what is gathered at its samples, and, for bright lights, at eight times as many.
  check_memory(options.output, samples * (numbers * 4 * 11 + 9 * 50), "ask for fewer --samples");
  if (samples * numbers > 2e9)
    throw UsageError("--samples: such a table would hold more than two thousand million numbers");
}

// The environment as a cube as fine as the map itself, and a multiple of the size it is merged to.
CubeMap fine_cube(const EnvironmentMap& map, int merged) {
  constexpr int finest = 512;
  int size = merged;
  while (2 * size < map.height && 2 * size <= finest) size *= 2;
  return cube_from_environment(map, size);
}

void run_bake_fiv(const BakeFivOptions& options, const CommonOptions& common) {
  FivParams params = params_of(options);
  check_size(options, params);
  check_output(options.output, ".exr", common);
  if (!is_scene_name(options.mesh)) throw Error(options.mesh, "is no .gltf or .glb file", "convert the mesh");
  LoadedScene loaded = load_scene(options.mesh, options.load.load);
  EnvironmentInput environment = load_environment_input(options.environment);
  loaded.warnings.insert(loaded.warnings.end(), environment.warnings.begin(), environment.warnings.end());
  print_warnings(common, loaded.warnings);
  const FivOccluder occluder = make_fiv_occluder(loaded.scene);
  const CubeMap cube = fine_cube(to_latlong(std::move(environment.image)), params.environment_size);

  Progress progress(common, "baking", "directions");
  params.progress = progress.callback();
  const auto start = std::chrono::steady_clock::now();
  FivTable table = bake_fiv(occluder, cube, params);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  Metadata& m = table.metadata = environment.origin;
  m["version"] = std::string(IVORY_VERSION);
  m["method"] = std::string("fiv");
  m["mesh"] = std::filesystem::path(options.mesh).filename().string();
  m["mesh_hash"] = loaded.scene.content_hash;
  describe(options.load, m);
  keep_assumptions(m, loaded.warnings);
  const V3d center = to_world(occluder.center_m, occluder.anchor_m);
  if (occluder.anchor_m != V3d(0, 0, 0)) {
    // Floats do not hold a place far out.
    m["center_x_m"] = center.x;
    m["center_y_m"] = center.y;
    m["center_z_m"] = center.z;
  }
  m["environment_size"] = std::int64_t(params.environment_size);
  m["environment_parts"] = std::int64_t(params.parts);
  m["silhouette_pixels"] = std::int64_t(params.silhouette_pixels);
  m["fit"] = std::string(params.fit ? "least squares" : "none");
  m["units"] = std::string("lux");
  write_fiv(options.output, table, options.precision, common.force);

  const std::uint64_t bytes = table.values.size() * (options.precision == ExrPrecision::float32 ? 4 : 2);
  nlohmann::ordered_json result;
  result["output"] = options.output;
  result["samples"] = {table.size.x, table.size.y, table.size.z};
  result["hemispheres"] = table.hemispheres;
  result["table_bytes"] = bytes;
  result["file_bytes"] = std::filesystem::file_size(options.output);
  result["center_m"] = shortest(occluder.center_m, occluder.anchor_m);
  result["radius_m"] = shortest(table.radius_m);
  result["radii"] = nlohmann::ordered_json::array();
  for (const float r : table.radii) result["radii"].push_back(shortest(r));
  result["coverage"] = shortest(table.coverage);
  result.update(to_json(table.metadata));
  result["seconds"] = seconds;
  result["warnings"] = loaded.warnings;
  print_result(common, result,
               fmt::format("{}: {} x {} x {} samples, {} hemisphere{}, {} of {}, {:.1f} s\n"
                           "bounding sphere of {:.4g} m around {:.4g} {:.4g} {:.4g}; spheres from {:.3g} to {:.3g} of "
                           "its radius\n",
                           options.output, table.size.x, table.size.y, table.size.z, table.hemispheres,
                           table.hemispheres == 1 ? "" : "s", format_bytes(bytes), name_of(options.precision), seconds,
                           table.radius_m, center.x, center.y, center.z, table.radii.front(), table.radii.back()));
}

}  // namespace

void add_bake_fiv_command(Command bake, CommonOptions& common) {
  Command command = bake.add_subcommand(
      "fiv", "Bake what a moving mesh hides of an environment's light into an FIV occluder table (.exr)");
  auto options = std::make_shared<BakeFivOptions>();
  command.add_option("mesh", options->mesh, "Occluder: all triangles of a .gltf or .glb file")
      .required()
      .type_name("MESH");
  command.add_option("-o,--output", options->output, "Table to write, .exr").required().type_name("OUT.exr");
  add_environment_options(command, options->environment);
  add_scene_options(command, options->load);
  command.get_option("--env").required();
  command.add_option("--samples", options->samples, "Samples in azimuth, polar angle and distance")
      .type_name("NA,NP,ND");
  command
      .add_option("--hemispheres", options->params.hemispheres,
                  "1: one vector per colour and sample, as published; 6: the vectors of six hemispheres, four\n"
                  "times the memory, right where the occluder reaches below a receiver's plane")
      .one_of({"1", "6"});
  command.add_choice("--precision", options->precision, "Of the file's numbers");
  command
      .add_option("--env-size", options->params.environment_size,
                  "Dim parts of the environment are merged to a cube of that many texels a face's edge")
      .within(1, 512);
  command.add_count("--parts", options->params.parts, 1, 1'000'000,
                    "Bright parts stay apart, as fine as the map is, until none carries more than 1 / PARTS of\n"
                    "all light; 1 merges them too");
  command.add_option("--farthest", options->params.farthest, "Outermost sphere, in radii of the bounding sphere")
      .within(1.5, 1000.0);
  command
      .add_option("--silhouette", options->params.silhouette_pixels,
                  "Pixels across the bounding sphere by which the mesh's outline is known; half as many for\n"
                  "dim parts of the environment, four times as many for the brightest")
      .within(8, 1024);
  command.footer(
      "The table serves the mesh wherever it is moved to, evenly scaled, under that environment, not turned.\n"
      "The same command gives the same bytes with any --threads.\n"
      "\nExamples:\n"
      "  ivory bake fiv bunny.glb --env sky.hdr -o bunny.exr --hemispheres 6\n"
      "  ivory render plaza.glb --env sky.hdr --object bunny.glb@1,0,2 --occluder bunny=bunny.exr --method fiv -o "
      "a.png");
  set_action(command, common, Output::file, [options, &common] { run_bake_fiv(*options, common); });
}

}  // namespace ivory
