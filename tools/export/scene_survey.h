// What a reader of probes shows on a scene's surfaces.
#pragma once

#include "grid/export/survey/survey.h"
#include "tools/cli/common.h"
#include "tools/input/scene.h"

namespace ivory {

// The scene that a grid was baked from, as it was taken then (--scale, --time, --animation, --without). Notes where it
// is another one. Throws Error as load_gltf() does. Moves the grid to the scene's anchor.
SceneInput load_scene_of_grid(const std::string& path, IrradianceGrid& grid, const CommonOptions& common);

struct SceneSurvey {
  ReaderSurvey survey;
  double area_m2 = 0;  // of the surfaces that points were drawn on
};

// At up to `points` points within the grid, spread evenly over the sides of surfaces that the eye sees, against the
// grid's look-up guarded by rays; not where no vertex sees them. The same for the same seed.
SceneSurvey survey_scene(const Scene& scene, const Intersector& intersector, const IrradianceGrid& grid,
                         const ProbeReader& reader, int points, float apart_m, std::uint64_t seed);

}  // namespace ivory
