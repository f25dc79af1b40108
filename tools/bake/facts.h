// What bakes judge of their results and keep of their making in the assets, whoever asks for them: the command line and
// the Python package write the same bytes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "grid/env/irradiance.h"
#include "grid/field/evidence.h"
#include "grid/io/sh9.h"
#include "grid/lobes/table.h"
#include "tools/input/scene.h"
#include "tracer/bake/cubemap/capture.h"
#include "tracer/bake/field/contract/contract.h"
#include "tracer/bake/fiv/baker.h"
#include "tracer/bake/spheres/fit.h"

namespace ivory {

// Of a grid: leaves the scene's facts, and with a contract the certificate, in the metadata of the sums or the grid, to
// be written with them. `domain` is where the error was asked for, or "points"; `asked`: was a target given?
void keep_origin(const Metadata& origin, GridVertices& grid);
void keep_contract(ContractResult& result, const std::string& domain, bool asked,
                   const std::optional<double>& most_seconds);
// What photons left too little of, in words; empty where there is enough.
std::string few_photons_text(const Evidence& found);
// The grid of all photons, with its groups, photon range, ledger and `doubt` (few_photons_text()) in the metadata. The
// sums, by far the largest part, are emptied.
IrradianceGrid finish_grid(GridAccumulator& sums, const std::string& doubt);

// How nine coefficients are chosen and smoothed.
struct Sh9Choices {
  std::optional<int> order;     // none: the lowest that meets max_error
  double max_error = 0.01;      // average, as a share of the light of the whole sphere
  std::string window = "none";  // auto, or the width of a Hann window in bands
};
// Throws ParameterError ("window") for what is none of these.
Sh9Window chosen_window(const std::string& window, const Sh9& sh);
// Texels of the irradiance map whose normals their errors are measured at: 6 x 32 x 32.
inline constexpr int sh9_truth_size = 32;
// The coefficients `whole` of an environment (facts `origin`), whose irradiance is `truth` and whose light amounts to
// `total`, nits sr.
Sh9Asset make_sh9_asset(const Sh9& whole, const Sh9Choices& choices, const CubeMap& truth, const V3d& total,
                        Metadata origin);

// The map `baked` of the environment with these facts, light and error of nine coefficients.
DifMap make_difmap(IrradianceMap baked, const V3d& total, const Sh9Error& sh9, Metadata origin);

// A mesh that is no scene: its file and how it was read.
struct MeshInput {
  std::string path;
  SceneOptions options;
  LoadedScene loaded;
};
// Throws Error for names of no scene file, and as load_scene() does.
MeshInput load_mesh_input(const std::string& path, const SceneOptions& options, const CommonOptions& common);

// Memory that a bake takes: the table, what is gathered at its samples, and, for bright lights, at eight times as many.
double fiv_bake_bytes(const FivParams& params);
// Of a table of that occluder under an environment with the facts `origin`.
Metadata fiv_facts(const MeshInput& mesh, const FivOccluder& occluder, const FivParams& params, Metadata origin);
// The environment as a cube as fine as the map itself, and a multiple of the size it is merged to.
CubeMap fine_cube(const EnvironmentMap& map, int merged);

// Of a sphere set; asked_for: the count, where one was given.
Metadata sphere_facts(const MeshInput& mesh, const SphereFit& fit, const std::optional<int>& asked_for);

// Refuses captures that nothing can be lit by, and says what looks like a mistake. `at` is in the world, metres.
std::vector<std::string> judge_capture(const std::string& file, const V3d& at, const Capture& capture,
                                       const Scene& scene);
// Of a cube map that path tracing, or the look-ups of a grid, made. `warnings` are those of judge_capture() and of the
// look-ups.
Metadata cubemap_facts(const Metadata& origin, const CaptureParams& params, ShellFit shell,
                       const std::vector<std::string>& warnings);

// Of a table of lobe products.
Metadata lobe_facts(const LobeTableErrors& errors, std::uint64_t seed);

}  // namespace ivory
