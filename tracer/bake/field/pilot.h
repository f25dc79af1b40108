// The first few photons of a bake: what part of each light's emission reaches the grid, and how bright it is where.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "grid/field/irradiance_grid.h"
#include "tracer/core/lit_scene.h"
#include "tracer/render/photons/aim.h"
#include "tracer/render/photons/window.h"

namespace ivory {

struct PilotParams {
  std::uint64_t photons = 0;  // of the bake; the pilot traces about a thirtieth of them
  int max_bounces = 1000;
  DirectSources include_direct = {};
  std::uint64_t seed = 1;
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;  // photons; called from any thread
};

struct Pilot {
  Lights::Emission emission;
  std::shared_ptr<const PhotonWindow> window;  // null: all photons are left as they are
  std::optional<PhotonAim> aim;
  std::uint64_t photons = 0;  // traced; 0: the bake is too small to be guided
  // Share of photons that come to the grid, of those that count there.
  double reach_before = 0;
  double reach_after = 0;
};

// For a bake of that grid by that emission. It has random numbers of its own, the same whatever range of the bake's
// photons is traced and on however many threads: its photons are not counted in any grid, because photons of the bake
// must not depend on themselves. Where none of them comes to the grid, nothing is guided.
Pilot run_pilot(const LitScene& lit, const GridFrame& frame, const Lights::Emission& emission,
                const PilotParams& params);

}  // namespace ivory
