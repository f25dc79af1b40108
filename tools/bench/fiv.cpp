// ivory bench fiv: what an FIV table costs and how far it is from brute force.
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/env/environment_image.h"
#include "grid/env/latlong_map.h"
#include "grid/io/environment.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/environment.h"
#include "tools/input/scene.h"
#include "tools/stability/measure_fiv.h"

namespace ivory {

namespace {

using Json = nlohmann::ordered_json;

struct BenchFivOptions {
  std::string mesh;
  SceneOptions load;
  EnvironmentChoice environment;
  std::string light;
  std::string samples = "64,33,30";
  int truth_size = 64;
  bool times = false;
};

struct Case {
  std::string name;
  FivPlane plane;
  std::vector<V3f> copies;
};

// Forty places in a box over the plane, evenly strewn (Roberts's sequence of dimension 3).
std::vector<V3f> strewn() {
  std::vector<V3f> out;
  for (int i = 1; i <= 40; ++i) {
    const auto part = [i](double step) { return float(std::fmod(0.5 + step * i, 1.0)); };
    out.emplace_back(10 * part(0.8191725134) - 5, 5 * part(0.6710436067), 10 * part(0.5497004779) - 5);
  }
  return out;
}

// Planes under, at the foot of, and through the occluder, and several occluders over one plane so close that
// their shadows meet.
std::vector<Case> make_cases(const FivOccluder& occluder) {
  float lowest = 0;
  for (const Instance& instance : occluder.scene.instances) {
    for (const V3f& p : occluder.scene.meshes[std::size_t(instance.mesh)].positions)
      lowest = std::min(lowest, (p * instance.to_world).y);
  }
  FivPlane under;
  under.point.y = -1.02F;
  FivPlane foot;
  foot.point.y = lowest;
  FivPlane through;
  through.point.y = -0.3F;
  through.n = V3f(0.35F, 0.9F, 0.2F).normalized();
  FivPlane wide = under;
  wide.half_side = 4;
  FivPlane wider = under;
  wider.half_side = 6;
  const V3f here(0, 0, 0);
  return {{"floating", under, {here}},
          {"standing", foot, {here}},
          {"tilted", through, {here}},
          {"two", wide, {V3f(-0.6F, 0, 0), V3f(0.6F, 0.7F, 0.5F)}},
          {"four", wide, {V3f(-0.9F, 0, -0.3F), V3f(0.7F, 0.3F, 0.7F), V3f(0.1F, 1.4F, -0.2F), V3f(1.1F, 0.1F, -1)}},
          {"forty", wider, strewn()}};
}

CubeMap make_light(const BenchFivOptions& options, const CommonOptions& common) {
  if (options.light == "one") return one_light(32);
  if (options.light == "two") return two_area_lights(32);
  EnvironmentInput input = load_environment_input(options.environment);
  print_warnings(common, input.warnings);
  return cube_from_environment(to_latlong(std::move(input.image)), options.truth_size);
}

void run(const BenchFivOptions& options, const CommonOptions& common) {
  if (options.light.empty() == options.environment.path.empty()) throw UsageError("give either --env or --light");
  if (options.truth_size % 32 != 0) throw UsageError("--truth must be a multiple of 32");
  FivParams params;
  params.samples = parse_size3("--samples", options.samples, 3);
  params.hemispheres = 6;
  const FivOccluder occluder = make_fiv_occluder(load_scene(options.mesh, options.load.load).scene);
  const CubeMap light = make_light(options, common);
  Progress progress(common, "measuring", "steps");
  Json result{{"mesh", options.mesh}, {"samples", {params.samples.x, params.samples.y, params.samples.z}}};
  std::string human;

  const FivTable six = bake_fiv(occluder, light, params);
  const FivTable one = first_hemisphere(six);
  const std::vector<Case> cases = make_cases(occluder);
  std::uint64_t done = 0;
  for (const Case& c : cases) {
    progress.update(done++, cases.size());
    const FivReference truth = reference_by_rays(occluder, light, c.plane, c.copies);
    const auto error = [&](const FivTable& table, Straddling straddling, FivOverlap overlap) {
      return shadow_nrmse(irradiance_by_table(table, c.plane, c.copies, truth.unshadowed, {straddling, overlap}),
                          truth);
    };
    Json errors;
    if (c.copies.size() == 1) {
      errors["one_vector"] = error(one, Straddling::bound, FivOverlap::none);
      errors["published_scale"] = error(one, Straddling::scale, FivOverlap::none);
      errors["six_hemispheres"] = error(six, Straddling::bound, FivOverlap::none);
    } else {
      errors["uncorrected"] = error(six, Straddling::bound, FivOverlap::none);
      errors["discs"] = error(six, Straddling::bound, FivOverlap::discs);
      errors["covers"] = error(six, Straddling::bound, FivOverlap::covers);
      errors["product"] = error(six, Straddling::bound, FivOverlap::product);
    }
    human += fmt::format("{:<9}", c.name);
    for (const auto& [key, value] : errors.items()) human += fmt::format("  {} {:.4f}", key, value.get<double>());
    human += "\n";
    result["nrmse"][c.name] = std::move(errors);
  }
  const FivReadTime read = time_reading(occluder, six, cases.front().plane);
  const FivReadTime read_one = time_reading(occluder, one, cases.front().plane);
  result["read_six_ns"] = read.table_ns;
  result["read_one_ns"] = read_one.table_ns;
  result["occlusion_ray_ns"] = read.ray_ns;
  human += fmt::format(
      "one receiver and occluder: {:.0f} ns from one vector a sample, {:.0f} ns from six hemispheres; one occlusion "
      "ray "
      "{:.0f} ns\n",
      read_one.table_ns, read.table_ns, read.ray_ns);
  if (options.times) {
    FivParams plain;
    plain.parts = 1;
    const FivBakeTime time = compare_with_rays(occluder, light, plain, 199);
    result["bake_s"] = time.table_s;
    result["rays_s"] = time.rays_s;
    result["bake_over_rays"] = time.table_s / time.rays_s;
    result["rms_difference"] = time.rms_difference;
    human += fmt::format(
        "128 x 65 x 30 samples, 6 x 32 x 32 lights: {:.2f} s; one occlusion ray for each {:.1f} s (from every 199th "
        "sample): ratio {:.3f}; RMS difference {:.5f} of the largest value\n",
        time.table_s, time.rays_s, time.table_s / time.rays_s, time.rms_difference);
  }
  print_result(common, result, human);
}

}  // namespace

void add_bench_fiv_command(Command bench, CommonOptions& common) {
  Command command = bench.add_subcommand(
      "fiv", "Error of shadows from FIV tables on planes (NRMSE of E against rays to every texel), and their costs.");
  auto options = std::make_shared<BenchFivOptions>();
  command.add_option("MESH", options->mesh, "glTF file of the occluder").required();
  add_environment_options(command, options->environment);
  add_scene_options(command, options->load);
  command.add_option("--light", options->light, "Instead of --env: one light of one texel, or two coloured discs")
      .one_of({"one", "two"});
  command.add_option("--samples", options->samples, "Of the table").type_name("NA,NP,ND");
  command.add_option("--truth", options->truth_size, "Texels along a cube face of the environment that rays go to")
      .within(32, 512);
  command.add_flag("--times", options->times,
                   "Time the bake of 128 x 65 x 30 samples beside one ray a sample and light");
  command.footer("Example:\n  ivory bench fiv bunny.glb --env sky.hdr --times");
  set_action(command, common, Output::none, [options, &common] { run(*options, common); });
}

}  // namespace ivory
