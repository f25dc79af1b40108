// ivory bake spheres: a mesh as a sphere set that casts its shadows.
#include <chrono>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/io/json.h"
#include "grid/io/sphere_set.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/assumptions.h"
#include "tools/input/scene.h"
#include "tracer/bake/spheres/fit.h"

namespace ivory {

namespace {

struct BakeSpheresOptions {
  std::string mesh;
  std::string output;
  SceneOptions load;
  int count = 64;
  int resolution = 0;
};

void run(const BakeSpheresOptions& options, const CommonOptions& common) {
  check_output(options.output, ".json", common);
  if (!is_scene_name(options.mesh)) throw Error(options.mesh, "is no .gltf or .glb file", "convert the mesh");
  const LoadedScene loaded = load_scene(options.mesh, options.load.load);
  print_warnings(common, loaded.warnings);

  SphereFitParams params;
  params.count = options.count;
  params.resolution = options.resolution;
  Progress progress(common, "fitting", "steps");
  params.progress = [&](double fraction) { progress.update(std::uint64_t(fraction * 1000), 1000); };
  const auto start = std::chrono::steady_clock::now();
  SphereFit fit = fit_spheres(loaded.scene, params);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const SphereFitErrors& e = fit.errors;
  Metadata& m = fit.set.metadata;
  m["version"] = std::string(IVORY_VERSION);
  m["method"] = std::string("least symmetric difference, variational");
  m["mesh"] = std::filesystem::path(options.mesh).filename().string();
  m["mesh_hash"] = loaded.scene.content_hash;
  describe(options.load, m);
  keep_assumptions(m, loaded.warnings);
  m["count"] = std::int64_t(fit.set.spheres.size());
  m["asked_for"] = std::int64_t(options.count);
  m["solid"] = std::string(fit.solid ? "yes" : "no");
  m["resolution"] = std::int64_t(fit.resolution);
  m["surface_weight"] = fit.surface_weight;
  m["bounding_radius_m"] = e.bounding_radius_m;
  m["mesh_volume_m3"] = e.mesh_volume_m3;
  m["volume_outside"] = e.volume_outside;
  m["volume_uncovered"] = e.volume_uncovered;
  m["surface_uncovered"] = e.surface_uncovered;
  m["surface_mean"] = e.surface_mean;
  m["surface_farthest"] = e.surface_farthest;
  write_spheres(options.output, fit.set, common.force);

  nlohmann::ordered_json result;
  result["output"] = options.output;
  result.update(to_json(m));
  result["seconds"] = seconds;
  result["warnings"] = loaded.warnings;
  std::string human = fmt::format("{}: {} spheres, {} voxels along the longest side, {:.2f} s\n", options.output,
                                  fit.set.spheres.size(), fit.resolution, seconds);
  human += fmt::format("volume: {:.2f} % of the {} outside the mesh, {:.2f} % uncovered\n", 100 * e.volume_outside,
                       fit.solid ? "mesh's" : "bounding sphere's", 100 * e.volume_uncovered);
  human += fmt::format(
      "surface: {:.2f} % of it farther than 2 % of the bounding radius beyond the spheres, mean distance {:.2f} %, "
      "farthest {:.2f} %\n",
      100 * e.surface_uncovered, 100 * e.surface_mean, 100 * e.surface_farthest);
  if (!fit.solid) human += "the mesh encloses next to no volume: spheres cover its surface\n";
  print_result(common, result, human);
}

}  // namespace

void add_bake_spheres_command(Command bake, CommonOptions& common) {
  Command command = bake.add_subcommand("spheres", "A mesh as a set of spheres, which casts its shadows");
  auto options = std::make_shared<BakeSpheresOptions>();
  command.add_option("mesh", options->mesh, "Mesh: .gltf or .glb, all of its scene, in its world space")
      .required()
      .type_name("MESH");
  command.add_option("-o,--output", options->output, "Sphere set to write").required().type_name("OUT.json");
  command.add_count("--count", options->count, 1, 4096, "Spheres, 4096 at most");
  command.add_option("--resolution", options->resolution, "Voxels along the longest side [48 to 160 by --count]")
      .within(16, 192);
  add_scene_options(command, options->load);
  command.footer(
      "The volume that the spheres add and the volume that they leave out are made as small as can be, in sum.\n"
      "\nExample:\n"
      "  ivory bake spheres bunny.glb -o bunny.json --count 64");
  set_action(command, common, Output::file, [options, &common] { run(*options, common); });
}

}  // namespace ivory
