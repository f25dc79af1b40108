#include "tools/bake/facts.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/field/resolve.h"
#include "tools/cli/numbers.h"
#include "tools/input/assumptions.h"

namespace ivory {

namespace {

void keep_version(Metadata& m) { m["version"] = std::string(IVORY_VERSION); }

void keep_mesh(const MeshInput& mesh, Metadata& m) {
  m["mesh"] = std::filesystem::path(mesh.path).filename().string();
  m["mesh_hash"] = mesh.loaded.scene.content_hash;
  describe(mesh.options, m);
  keep_assumptions(m, mesh.loaded.warnings);
}

}  // namespace

void keep_origin(const Metadata& origin, GridVertices& grid) {
  for (const auto& [key, value] : origin) grid.metadata[key] = value;
  keep_version(grid.metadata);
}

void keep_contract(ContractResult& result, const std::string& domain, bool asked,
                   const std::optional<double>& most_seconds) {
  Metadata& m = result.sums.metadata;
  if (result.certificate) keep_field_certificate(*result.certificate, m);
  m["contract_rounds"] = std::int64_t(result.rounds);
  m["contract_predicted_error"] = result.plan.error.expected;
  m["contract_domain"] = domain;
  if (!asked) m["contract_default"] = std::string("no error was asked for");
  if (result.by_clock) m["contract_max_time_s"] = *most_seconds;
}

std::string few_photons_text(const Evidence& found) {
  if (found.vertices > 0 && found.unmet == found.vertices)
    return "nothing of the light reaches the grid: no photon came to any of its vertices, and all of it is 0";
  const std::size_t met = found.vertices - found.unmet;
  if (4 * found.few <= met) return {};
  return fmt::format("{:.0f} % of the vertices that light reaches rest on fewer than {:.0f} photons",
                     100 * double(found.few) / double(met), few_photons);
}

IrradianceGrid finish_grid(GridAccumulator& sums, const std::string& doubt) {
  IrradianceGrid grid = resolve_groups(sums);
  std::vector<std::int64_t>().swap(sums.sums);  // gives the memory back, which = {} does not
  std::vector<SumGroup>().swap(sums.groups);
  if (!doubt.empty()) grid.metadata["few_photons"] = doubt;
  grid.metadata["photon_begin"] = std::int64_t(sums.photon_begin);
  grid.metadata["photon_end"] = std::int64_t(sums.photon_end);
  for (const auto& [key, value] : sums.counters) grid.metadata[key] = value;
  return grid;
}

Sh9Window chosen_window(const std::string& window, const Sh9& sh) {
  if (window == "none") return {};
  if (window == "auto") return least_window(sh);
  const std::optional<double> width = parse_number(window);
  if (!width || !(*width >= 2 && *width <= 1e6))
    throw ParameterError("window", "it takes none, auto or a width from 2 to 1000000, not '" + window + "'");
  return hann_window(*width);
}

Sh9Asset make_sh9_asset(const Sh9& whole, const Sh9Choices& choices, const CubeMap& truth, const V3d& total,
                        Metadata origin) {
  Sh9Asset asset;
  for (int order = choices.order.value_or(0); order <= choices.order.value_or(2); ++order) {
    asset.order = order;
    asset.sh = truncated(whole, order);
    asset.window = chosen_window(choices.window, asset.sh);
    asset.sh = windowed(asset.sh, asset.window);
    asset.error = sh9_error(asset.sh, truth, total);
    if (asset.error.average <= choices.max_error) break;
  }
  asset.metadata = std::move(origin);
  asset.metadata["method"] = std::string("sh9");
  return asset;
}

DifMap make_difmap(IrradianceMap baked, const V3d& total, const Sh9Error& sh9, Metadata origin) {
  double bound = 0;
  for (int c = 0; c < 3; ++c)
    if (total[c] > 0) bound = std::max(bound, baked.error_bound[c] / total[c]);
  DifMap map{std::move(baked.e), std::move(origin)};
  map.metadata["method"] = std::string("difmap");
  map.metadata["size"] = std::int64_t(map.e.size);
  map.metadata["error_bound"] = bound;
  map.metadata["sh9_average_error"] = sh9.average;
  map.metadata["sh9_maximum_error"] = sh9.maximum;
  return map;
}

MeshInput load_mesh_input(const std::string& path, const SceneOptions& options, const CommonOptions& common) {
  if (!is_scene_name(path)) throw Error(path, "is no .gltf or .glb file", "convert the mesh");
  return {path, options, load_scene(path, options.load, common)};
}

double fiv_bake_bytes(const FivParams& params) {
  const double samples = double(params.samples.x) * double(params.samples.y) * double(params.samples.z);
  return samples * (3 * fiv_function_count(params.hemispheres) * 4 * 11 + 9 * 50);
}

Metadata fiv_facts(const MeshInput& mesh, const FivOccluder& occluder, const FivParams& params, Metadata origin) {
  Metadata m = std::move(origin);
  keep_version(m);
  m["method"] = std::string("fiv");
  keep_mesh(mesh, m);
  if (occluder.anchor_m != V3d(0, 0, 0)) {
    // Floats do not hold a place far out.
    const V3d center = to_world(occluder.center_m, occluder.anchor_m);
    m["center_x_m"] = center.x;
    m["center_y_m"] = center.y;
    m["center_z_m"] = center.z;
  }
  m["environment_size"] = std::int64_t(params.environment_size);
  m["environment_parts"] = std::int64_t(params.parts);
  m["silhouette_pixels"] = std::int64_t(params.silhouette_pixels);
  m["fit"] = std::string(params.fit ? "least squares" : "none");
  m["units"] = std::string("lux");
  return m;
}

CubeMap fine_cube(const EnvironmentMap& map, int merged) {
  constexpr int finest = 512;
  int size = merged;
  while (2 * size < map.height && 2 * size <= finest) size *= 2;
  return cube_from_environment(map, size);
}

Metadata sphere_facts(const MeshInput& mesh, const SphereFit& fit, const std::optional<int>& asked_for) {
  const SphereFitErrors& e = fit.errors;
  Metadata m;
  keep_version(m);
  m["method"] = std::string("least symmetric difference, variational");
  keep_mesh(mesh, m);
  m["count"] = std::int64_t(fit.set.spheres.size());
  if (asked_for) m["asked_for"] = std::int64_t(*asked_for);
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
  return m;
}

std::vector<std::string> judge_capture(const std::string& file, const V3d& at, const Capture& capture,
                                       const Scene& scene) {
  const std::string place = fmt::format("({}, {}, {})", at.x, at.y, at.z);
  const bool dark = std::all_of(capture.cube.radiance.texels.begin(), capture.cube.radiance.texels.end(), is_black);
  if (capture.sky_share > 0.999999 && !scene.environment) {
    throw Error(file, "has nothing to be seen from " + place,
                "choose a point within the scene, or give an environment");
  }
  const bool backs = capture.back_share > 0.5 * (1 - capture.sky_share);
  if (backs && dark) {
    throw Error(
        file,
        place + " lies inside a wall or outside of the scene: only backs of surfaces and no light are seen from there",
        "choose a point in the open");
  }
  std::vector<std::string> warnings;
  if (backs) {
    warnings.push_back(
        fmt::format("{:.0f} % of what is seen from {} are backs of single-sided surfaces: it may lie inside a wall",
                    100 * capture.back_share, place));
  } else if (dark) {
    warnings.push_back("no light arrives at " + place + ": the cube map is black");
  }
  if (!bounds(scene).intersects(to_local(at, scene.anchor_m)))
    warnings.push_back(place + " lies outside of the scene's bounds");
  return warnings;
}

Metadata cubemap_facts(const Metadata& origin, const CaptureParams& params, ShellFit shell,
                       const std::vector<std::string>& warnings) {
  Metadata m = origin;
  keep_version(m);
  m["method"] = std::string("localized cube map");
  m["indirect"] = std::string(params.grid != nullptr ? "grid" : "path");
  m["capture_size"] = std::int64_t(params.size);
  m["samples"] = std::int64_t(params.samples);
  m["seed"] = std::int64_t(params.seed);
  m["shell"] = std::string(name_of(shell));
  m["units"] = std::string("nits, 1/m");
  keep_assumptions(m, warnings);
  return m;
}

Metadata lobe_facts(const LobeTableErrors& errors, std::uint64_t seed) {
  Metadata m;
  keep_version(m);
  m["method"] = std::string("moments");
  m["error_samples"] = std::int64_t(errors.samples);
  m["error_seed"] = std::int64_t(seed);
  const auto keep = [&](const std::string& name, const LobeTableErrors::Distribution& d) {
    m[name + "_mean"] = d.mean;
    m[name + "_median"] = d.median;
    m[name + "_worst"] = d.worst;
  };
  keep("integral_error", errors.absolute);
  keep("integral_error_relative", errors.of_true);
  return m;
}

}  // namespace ivory
