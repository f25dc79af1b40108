// Scenes with closed forms, for the stability suite.
#pragma once

#include <numbers>
#include <vector>

#include "tools/stability/scene_builder.h"
#include "tracer/bake/field/baker.h"
#include "tracer/render/guard_rays.h"
#include "tracer/render/probe.h"

namespace ivory {

inline constexpr double pi_d = std::numbers::pi;

// Two closed boxes beside each other, side_m high and deep and half as wide each, parted by a wall. All faces of the
// left one emit 1 nit and reflect half of what they receive: a furnace, L = 2 and E = 2 pi at every point of its
// surfaces. Nothing shines in the right one.
struct Chambers {
  float side_m = 2;
  float thickness_m = 0.1F;  // of the wall
  float wall_x_m = 0;        // its middle
  M44f to_world;             // rotation, scale, translation of everything
};
inline constexpr float chamber_irradiance = 2 * pi;  // lux, on the lit side
Scene make_chambers(const Chambers& chambers);

// The same light before a wall that is one two-sided sheet (thickness_m must be 0): the left chamber's other faces emit
// 2 nits and reflect nothing, the sheet reflects all, L = 2 everywhere again. Nothing passes it.
Scene make_sheet_chambers(const Chambers& chambers);

// Points on the wall (world), `count` a side of a square lattice whose lines no grid shares, from edge to edge.
std::vector<ProbePoint> lit_wall_points(const Chambers& chambers, int count);
std::vector<ProbePoint> dark_wall_points(const Chambers& chambers, int count);

// Mean E over points over chamber_irradiance, as read from the grid with that guard.
double mean_share(const LitScene& world, const IrradianceGrid& grid, Guard guard,
                  const std::vector<ProbePoint>& points);

// Photons that hold all light (direct light included), so that closed forms apply; guard `rays` stores the planes too.
IrradianceGrid bake_all_light(const LitScene& world, GridBakeParams params);

double surface_area_m2(const Mesh& mesh);

// E at p with normal n from a polygon of radiance 1 that is above p's horizon as a whole (Lambert's formula);
// whichever way its corners run.
double polygon_irradiance(const std::vector<V3d>& corners, const V3d& p, const V3d& n);

// E of a ball of radiance 1 whose squared sine of the half-angle is sine2, its centre at `cosine` from the normal;
// what is below the horizon does not count (form factor of a sphere to a tilted element).
double ball_irradiance(double cosine, double sine2);

}  // namespace ivory
