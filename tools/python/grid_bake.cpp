// Scene.bake_grid: the bake of `ivory bake grid`, with the same parameters and the same bytes.
#include <array>
#include <cmath>
#include <variant>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "grid/base/anchor.h"
#include "grid/io/vdb/vdb.h"
#include "tools/bake/grid/contract.h"
#include "tools/cli/target_error.h"
#include "tools/python/arrays.h"
#include "tools/python/assets.h"
#include "tools/python/work.h"
#include "tracer/bake/field/baker.h"
#include "tracer/bake/field/deposit/target.h"

namespace ivory::python {

namespace py = pybind11;

namespace {

using Point = std::array<double, 3>;
using Box = std::array<Point, 2>;
using Size = std::variant<int, std::array<int, 3>>;
using Groups = std::variant<std::string, py::dict>;
using Direct = std::variant<bool, std::vector<std::string>>;

Box3f to_box(const char* name, const Box& box, const V3d& anchor_m) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    require(std::isfinite(box[0][axis]) && std::isfinite(box[1][axis]) && box[0][axis] < box[1][axis], name,
            "a box is ((x0, y0, z0), (x1, y1, z1)), finite, each of the first below that of the second");
  }
  return {to_local({box[0][0], box[0][1], box[0][2]}, anchor_m), to_local({box[1][0], box[1][1], box[1][2]}, anchor_m)};
}

std::vector<LightGroupRule> to_rules(const Groups& groups) {
  std::vector<LightGroupRule> rules;
  if (const auto* word = std::get_if<std::string>(&groups)) {
    require(*word == "extras", "groups", "it is a dict of group: [patterns], or 'extras'");
    return rules;
  }
  for (const auto& [name, patterns] : std::get<py::dict>(groups)) {
    const bool one = py::isinstance<py::str>(patterns);
    rules.push_back({py::cast<std::string>(name), one ? std::vector<std::string>{py::cast<std::string>(patterns)}
                                                      : py::cast<std::vector<std::string>>(patterns)});
  }
  return rules;
}

DirectSources to_sources(const Direct& direct) {
  if (const bool* all = std::get_if<bool>(&direct)) return *all;
  DirectSources sources;
  for (const std::string& name : std::get<1>(direct)) {
    require(name == "punctual" || name == "area" || name == "sky", "direct", "kinds are punctual, area and sky");
    (name == "punctual" ? sources.punctual : name == "area" ? sources.area : sources.sky) = true;
  }
  return sources;
}

// (p, n) or (p, n, weights).
std::vector<DomainPoint> to_points(const py::object& given, const V3d& anchor_m) {
  std::vector<DomainPoint> points;
  if (given.is_none()) return points;
  const auto parts = py::tuple(given);
  require(parts.size() == 2 || parts.size() == 3, "error_points", "it is (p, n) or (p, n, weights)");
  const Vectors p(parts[0], "error_points");
  const Vectors n(parts[1], "error_points");
  require(p.count() == n.count() && p.count() >= 2, "error_points", "it takes two points or more, a normal for each");
  py::array_t<double, py::array::c_style | py::array::forcecast> weights;
  if (parts.size() == 3) {
    weights = py::cast<decltype(weights)>(parts[2]);
    require(std::size_t(weights.size()) == p.count(), "error_points", "it takes a weight for each point");
  }
  double sum = 0;
  for (std::size_t i = 0; i < p.count(); ++i) {
    const double weight = parts.size() == 3 ? weights.data()[i] : 1;
    const V3f at = p.local(i, anchor_m);
    const V3f normal = n.local(i, V3d(0, 0, 0));
    require(weight >= 0 && std::isfinite(at.x + at.y + at.z) && std::abs(normal.length2() - 1) < 2e-3F, "error_points",
            "positions must be finite, normals unit vectors, weights 0 or more");
    points.push_back({at, normal, weight, true});
    sum += weight;
  }
  require(sum > 0, "error_points", "all weights are 0");
  return points;
}

// An error that is asked for, and where.
struct AskedError {
  std::optional<double> target;
  std::optional<double> most_seconds;
  std::string domain;
  std::vector<DomainPoint> points;
};

// What is baked, and what is to be said of it.
struct Baked {
  GridAccumulator sums;
  std::vector<std::string> warnings;
};

Baked bake_plain(const SceneAsset& scene, GridBakeParams params, Job& job) {
  params.pilot_progress = job.counts("pilot");
  params.progress = job.counts("baking");
  return {bake_grid_sums(scene.input.lit, params), {}};
}

Baked bake_contract(const SceneAsset& scene, const GridBakeParams& bake, const AskedError& error, bool fixes_grid,
                    Job& job) {
  ContractParams params;
  params.bake = bake;
  params.target = error.target.value_or(default_target_error);
  params.domain = choice<DomainKind>("error_domain", error.domain);
  params.points = error.points;
  params.lookup.guard = bake.guard == Guard::off ? Guard::off : Guard::rays;
  params.most_seconds = error.most_seconds;
  if (!error.target && !fixes_grid) params.most_work = 1;
  params.note = job.notes();
  params.bake.pilot_progress = job.counts("pilot");
  params.bake.progress = job.counts("baking");
  ContractResult result = bake_to_error(scene.input.lit, params);
  keep_contract(result, error.points.empty() ? error.domain : "points", error.target.has_value(), error.most_seconds);
  std::vector<std::string> warnings;
  if (!result.certificate) {
    warnings.emplace_back("its error is not known: light reaches too few points");
  } else if (const std::string missed = missed_text(result.certificate->summary); !missed.empty()) {
    warnings.push_back(missed + (result.plan.limited_by.empty() ? "" : "; limited by " + result.plan.limited_by));
  }
  if (error.most_seconds) warnings.emplace_back("max_time had a say: another machine may choose another grid");
  return {std::move(result.sums), std::move(warnings)};
}

GridAsset bake_grid(const SceneAsset& scene, const std::optional<Box>& bounds, float rotate_y,
                    const std::optional<Size>& resolution, std::optional<float> voxel_size, int levels,
                    const std::optional<std::vector<Box>>& dynamic, std::uint64_t photons, int bounces,
                    const std::optional<Groups>& groups, const Direct& direct, const std::string& emission,
                    const std::string& basis, const std::string& estimator, const std::string& guard,
                    std::uint64_t seed, std::uint64_t max_memory, std::optional<double> target_error,
                    std::optional<double> max_time, const std::string& error_domain, const py::object& error_points,
                    int threads, const py::object& progress) {
  const LitScene& lit = scene.input.lit;
  const V3d& anchor_m = lit.scene->anchor_m;
  require(rotate_y >= -360 && rotate_y <= 360, "rotate_y", "it must be from -360 to 360 degrees");
  require(!voxel_size || *voxel_size > 0, "voxel_size", "it must be above 0");
  require(!voxel_size || !resolution, "voxel_size", "it does not go with resolution");
  require(levels >= 1 && levels <= max_levels, "levels", "it must be from 1 to 12");
  require(bounces >= 1, "bounces", "it must be at least 1");
  GridBakeParams params;
  if (bounds) params.bounds = to_box("bounds", *bounds, anchor_m);
  params.rotate_y_deg = rotate_y;
  if (resolution) {
    const int* all = std::get_if<int>(&*resolution);
    params.resolution =
        all != nullptr ? V3i(*all, *all, *all)
                       : V3i(std::get<1>(*resolution)[0], std::get<1>(*resolution)[1], std::get<1>(*resolution)[2]);
  }
  params.voxel_size_m = voxel_size;
  params.levels = levels;
  if (dynamic) {
    params.dynamic_regions.emplace();
    for (const Box& box : *dynamic) params.dynamic_regions->push_back(to_box("dynamic", box, anchor_m));
  }
  params.photons = photons;
  params.max_bounces = bounces;
  params.include_direct = to_sources(direct);
  params.emission = choice<EmissionMode>("emission", emission);
  params.basis = choice<Basis>("basis", basis);
  params.estimator = choice<Estimator>("estimator", estimator);
  params.guard = choice<Guard>("guard", guard);
  params.seed = seed;
  params.threads = threads;
  params.max_memory_bytes = max_memory;
  if (groups) params.groups = make_light_groups(lit.lights, *lit.scene, to_rules(*groups));

  const bool fixes_grid = resolution || voxel_size || photons != 0;
  const bool contract = target_error || !fixes_grid;
  const AskedError error{target_error, max_time, error_domain, to_points(error_points, anchor_m)};
  require(!target_error || (*target_error > 0 && *target_error <= 1), "target_error",
          "it is a share, above 0 and at most 1: 0.02 for 2 %");
  require(!max_time || *max_time > 0, "max_time", "it must be above 0");
  require(contract || (!max_time && error_domain == "both" && error_points.is_none()), "target_error",
          "max_time, error_domain and error_points serve it: give that too");
  require(!contract || levels == 1, "levels", "a bake to an error chooses its levels itself");
  require(!contract || !params.include_direct || params.include_direct.all(), "direct",
          "an error is certified of all direct light or of none");

  GridAsset asset = run(progress, threads, [&](Job& job) {
    sum_layout(params.basis, params.estimator);  // refuses bases that the estimator cannot fill
    const Lattice placed = default_lattice(*lit.scene, params);
    check_estimator(placed, params.estimator);
    check_voxels(scene.path, placed.finest_frame());
    if (!contract || resolution || voxel_size) check_grid_memory(*lit.scene, placed, params);
    if (!contract) {
      params.lattice = placed;
    } else if (resolution || voxel_size) {
      params.frame = placed.frame;
    }
    Baked baked = contract ? bake_contract(scene, params, error, fixes_grid, job) : bake_plain(scene, params, job);
    check_voxels(scene.path, baked.sums.finest_frame());
    keep_origin(scene.input.origin, baked.sums);
    const std::string doubt = few_photons_text(evidence(baked.sums));
    GridAsset made{"grid of " + scene.path, finish_grid(baked.sums, doubt), std::move(baked.warnings)};
    if (!doubt.empty()) made.warnings.insert(made.warnings.begin(), doubt);
    for (std::string& warning : made.warnings) warning.insert(0, made.name + ": ");
    return made;
  });
  warn(asset.warnings);
  return asset;
}

}  // namespace

void bind_grid_bake(Classes& classes) {
  const GridBakeParams params;
  classes.scene.def(
      "bake_grid", &bake_grid, py::kw_only(), py::arg("bounds") = py::none(), py::arg("rotate_y") = 0.0F,
      py::arg("resolution") = py::none(), py::arg("voxel_size") = py::none(), py::arg("levels") = 1,
      py::arg("dynamic") = py::none(), py::arg("photons") = 0, py::arg("bounces") = params.max_bounces,
      py::arg("groups") = py::none(), py::arg("direct") = false, py::arg("emission") = "guided",
      py::arg("basis") = "vectors", py::arg("estimator") = "track", py::arg("guard") = "rays", py::arg("seed") = 1,
      py::arg("max_memory") = 0, py::arg("target_error") = py::none(), py::arg("max_time") = py::none(),
      py::arg("error_domain") = "both", py::arg("error_points") = py::none(), py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "Bakes the scene's indirect light, as 'ivory bake grid' does: to an error, unless resolution, voxel_size or "
      "photons are given.");
}

}  // namespace ivory::python
