// Grids around the inner edge of a room, and around a wall, made by hand.
#pragma once

#include <cmath>
#include <vector>

#include "grid/field/guard.h"

namespace ivory {

// 4 x 4 x 4 vertices 1 m apart without planes, moments still to be added.
inline IrradianceGrid grid_by_hand() {
  IrradianceGrid grid;
  grid.frame.size = V3i(4, 4, 4);
  grid.basis = Basis::ambient_cube;
  grid.visible_fraction.assign(64, 1.0F);
  grid.variance.assign(64, Rgb(0, 0, 0));
  grid.guard.assign(64, {});
  return grid;
}

// The room is x > 0.3, y > 0.3 m and has light of 1 lux for every normal. Vertices stand 1 m apart: those at x = 0 or
// y = 0 outside, where E is outside_lux. Planes keep those at x = 0 from the room, but for the ones at x = y = 0,
// behind the edge: no plane that goes by the room cuts off what they see outside of it, and so they have none. Those at
// y = 0 have them where they are lit.
inline IrradianceGrid inner_edge(float outside_lux) {
  IrradianceGrid grid = grid_by_hand();
  for (std::size_t v = 0; v < 64; ++v) {
    const V3i at = grid.frame.vertex_coordinates(v);
    const bool inside = at.x > 0 && at.y > 0;
    grid.moments.insert(grid.moments.end(), 18, inside ? 1.0F : outside_lux);
    std::size_t planes = 0;
    const auto add = [&](const V3f& normal, float distance) {
      grid.guard[v].words[planes++] = pack({normal, distance});
    };
    if (inside && at.x == 1) add(V3f(-1, 0, 0), 0.7F);
    if (inside && at.y == 1) add(V3f(0, -1, 0), 0.7F);
    if (at.x == 0 && at.y > 0) add(V3f(1, 0, 0), 0.28F);
    if (at.y == 0 && at.x > 0 && outside_lux > 0) add(V3f(0, 1, 0), 0.28F);
  }
  return grid;
}

struct SurfacePoint {
  V3f p;
  V3f n;
};

// On both walls, from 5 mm off the edge to 0.6 m.
inline std::vector<SurfacePoint> inner_edge_points() {
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 60; ++i) {
    const float off = 0.305F + 0.01F * float(i);
    points.push_back({V3f(0.3F, off, 1.3F), V3f(1, 0, 0)});
    points.push_back({V3f(off, 0.3F, 1.6F), V3f(0, 1, 0)});
  }
  return points;
}

// A wall across a grid of vertices 1 m apart, from x = 1.4 m on, `thickness_m` deep. Before it E is 1 lux for every
// normal; in it and behind it no light. Planes are exact; vertices in the wall see the inside of it.
inline IrradianceGrid before_a_wall(float thickness_m) {
  IrradianceGrid grid = grid_by_hand();
  const float front = 1.4F;
  const float back = front + thickness_m;
  for (std::size_t v = 0; v < 64; ++v) {
    const auto x = float(grid.frame.vertex_coordinates(v).x);
    grid.moments.insert(grid.moments.end(), 18, x < front ? 1.0F : 0.0F);
    std::size_t planes = 0;
    const auto add = [&](float normal, float distance) {
      if (std::abs(distance) < 1.2F) grid.guard[v].words[planes++] = pack({V3f(normal, 0, 0), distance});
    };
    if (x < front) add(1, front - x);
    if (x > front) add(-1, x > back ? x - back : x - front);
    if (x > front && x < back) add(1, back - x);
  }
  return grid;
}

}  // namespace ivory
