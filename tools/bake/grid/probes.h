// ivory bake grid --by probes: each vertex a light probe of its own, for comparison with photons.
#pragma once

#include "tools/cli/common.h"
#include "tools/input/scene.h"
#include "tracer/bake/field/grid_params.h"
#include "tracer/bake/field/probe_baker.h"

namespace ivory {

// What finds the light of a grid's vertices.
enum class GridLightBy { photons, probes };
template <>
inline constexpr auto name_table<GridLightBy> = make_name_table<GridLightBy>("by", {{GridLightBy::photons, "photons"},
                                                                                    {GridLightBy::probes, "probes"}});

struct ProbeBakeOptions {
  GridLightBy by = GridLightBy::photons;
  int rays = default_probe_rays;
  bool rays_given = false;

  explicit operator bool() const { return by == GridLightBy::probes; }
};

void add_probe_bake_options(Command command, ProbeBakeOptions& options);

// Throws UsageError for options of `params`, for an error (`contract`: one is asked for, or chooses the spacing) and
// for
// --checkpoint, which serve photons alone, and for --probe-rays without probes.
void check_probe_bake(const ProbeBakeOptions& options, const GridBakeParams& params, bool contract, bool checkpoint);

// Bakes where params.lattice says, writes the file and prints what was written.
void run_probe_bake(const std::string& output, const ProbeBakeOptions& options, GridBakeParams params,
                    const SceneInput& input, const CommonOptions& common);

}  // namespace ivory
