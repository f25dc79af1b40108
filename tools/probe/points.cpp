// ivory points: draws points on a scene's surfaces and in its free space, for `ivory probe`.
#include "tools/input/points.h"

#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/io/file.h"
#include "tools/cli/box.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/scene.h"
#include "tracer/bake/field/baker.h"
#include "tracer/bake/field/contract/certificate.h"

namespace ivory {

namespace {

struct PointsOptions {
  std::string scene;
  std::string output;
  SceneOptions load;
  EnvironmentChoice environment;
  std::optional<Imath::Box3d> bounds;  // in the world
  DomainKind domain = DomainKind::both;
  int count = 1000;
  std::uint64_t seed = 1;
  bool indirect_only = false;
};

void run_points(const PointsOptions& options, const CommonOptions& common) {
  check_output(options.output, ".csv", common);
  const auto input = load_scene_input(options.scene, options.load, options.environment, common);
  const Scene& scene = *input.lit.scene;
  if (input.lit.lights.empty())
    throw Error(options.scene, "nothing in it shines", "add a light, an emissive material or an environment");
  GridBakeParams bake;
  bake.resolution = V3i(64, 64, 64);  // tiles the box, which cubic voxels would overlap
  if (options.bounds)
    bake.bounds = {to_local(options.bounds->min, scene.anchor_m), to_local(options.bounds->max, scene.anchor_m)};
  const Domain domain(scene,
                      {.frame = default_frame(scene, bake), .kind = options.domain, .given = {}, .seed = options.seed});

  TruthParams truth;
  truth.indirect_only = options.indirect_only;
  truth.seed = options.seed;
  const TruePoints found = find_lit_points(input.lit, domain, 0, std::size_t(options.count), truth);
  std::string text = "x,y,z,nx,ny,nz\n";
  for (const TruePoint& point : found.lit) {
    const V3d p = to_world(point.at.p, scene.anchor_m);
    const V3f& n = point.at.n;
    text += fmt::format("{:.12g},{:.12g},{:.12g},{:.9g},{:.9g},{:.9g}\n", p.x, p.y, p.z, n.x, n.y, n.z);
  }
  const std::size_t drawn = found.lit.size();
  const std::size_t tried = drawn + found.dark.size();
  if (drawn == 0) {
    throw Error(options.scene, fmt::format("light reaches none of {} points tried", tried),
                "check its lights, --bounds and --domain; ivory info says what shines");
  }
  std::vector<std::string> warnings = input.warnings;
  if (drawn < std::size_t(options.count)) {
    warnings.push_back(fmt::format("{} points instead of {}: light reaches only {:.2g} % of those tried", drawn,
                                   options.count, 100 * double(drawn) / double(tried)));
    print_warnings(common, {warnings.back()});
  }
  write_file(options.output, text, common.force);
  const nlohmann::ordered_json result{
      {"file", options.output}, {"points", drawn}, {"dark", tried - drawn}, {"warnings", warnings}};
  print_result(common, result,
               fmt::format("{}: {} points that light reaches, of {} tried\n", options.output, drawn, tried));
}

}  // namespace

void add_points_command(Command app, CommonOptions& common) {
  Command command =
      app.add_subcommand("points", "Draw random points of a scene that light reaches, with normals, for 'ivory probe'");
  auto options = std::make_shared<PointsOptions>();
  command.add_option("scene", options->scene, "Scene: .gltf or .glb").required().type_name("SCENE");
  command.add_option("-o,--output", options->output, "Columns x,y,z (metres) and nx,ny,nz")
      .required()
      .type_name("OUT.csv");
  command.add_count("--count", options->count, 1, 100'000'000, "Points");
  command.add_choice("--domain", options->domain,
                     "Where they lie: evenly over surfaces, on either side; in space, with random normals;\n"
                     "or both, three quarters on surfaces");
  command
      .add_option(
          "--bounds", [options](const std::string& text) { options->bounds = parse_bounds("--bounds", text); },
          "Only within this box, in metres [the whole scene]")
      .type_name("X0,Y0,Z0:X1,Y1,Z1");
  command.add_flag("--indirect-only", options->indirect_only, "Light straight from its sources does not count");
  command.add_count("--seed", options->seed, "Seed of the random numbers");
  add_environment_options(command, options->environment);
  add_scene_options(command, options->load);
  command.footer(
      "Light reaches a point where one of 64 paths from it meets some: the measure of certificates\n"
      "(ivory bake grid --target-error).\n"
      "\nExamples:\n"
      "  ivory points room.glb -o p.csv --count 2k --indirect-only\n"
      "  ivory probe room.glb --points p.csv -o truth.csv --indirect-only --samples 16k\n"
      "  ivory probe room.vdb --points p.csv -o grid.csv --scene room.glb");
  set_action(command, common, Output::file, [options, &common] { run_points(*options, common); });
}

}  // namespace ivory
