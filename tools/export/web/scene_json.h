// What the page must know of a scene besides its .glb.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "grid/export/survey/survey.h"
#include "grid/field/irradiance_grid.h"
#include "tracer/core/lit_scene.h"

namespace ivory {

// The scene's perspective cameras, or one that shows all of it: name, position, target, up, yfov_deg; world, metres.
nlohmann::ordered_json views_json(const LitScene& lit);
// Punctual lights by the node of the file that placed them, and their groups in a grid that keeps groups apart.
nlohmann::ordered_json lamps_json(const Scene& scene, const IrradianceGrid& grid);
// Spherical lights: centre, radius and radiance.
nlohmann::ordered_json spheres_json(const Scene& scene);

// What display values are divided by: the factor that brings the first view to a mid exposure, found by a small picture
// lit by the grid.
double page_exposure(const LitScene& lit, const IrradianceGrid& grid);

// Ten bytes a point, little endian: place as three shares of 65535 of `low` to `low` + `extent`, normal as three shares
// of 127, and how far off it is as a share of 127 of `full`.
struct ErrorMap {
  std::string bytes;
  V3d low{0, 0, 0};  // world, metres
  V3d extent{0, 0, 0};
  double full = 0;  // of mean E: the end of the colours
};
ErrorMap make_error_map(const ReaderSurvey& survey, const V3d& anchor_m);

}  // namespace ivory
