// How much each photon should carry, by where it is: photons that carry more are split, those that carry less go on by
// lot with more (weight windows of particle transport: Booth & Hendricks, "Importance Estimation in Forward Monte Carlo
// Calculations", Nuclear Technology/Fusion 5, 1984).
//
// In a dark room beside a bright one few photons arrive, each with as much power as in the bright one: E is known there
// to ten per cent where it is known to a half next door. The relative variance of E in a place goes as P / E with P the
// power of a photon there, the time spent on it as E / P. For the sum over all places of relative variance, at a given
// time, P should go as E.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "grid/field/frame.h"

namespace ivory {

struct PhotonWindow {
  GridFrame frame;              // of cells, each around one of its vertices
  std::vector<float> power_lm;  // [cell] the strongest channel that a photon should carry

  // A photon is split that carries `split_above` times that, into pieces that carry as much as that and more; one that
  // carries a `lot_below` of it survives by a lot and then carries half of it.
  static constexpr float split_above = 3;
  static constexpr float lot_below = 0.125F;
  static constexpr int most_pieces = 8;            // at one surface
  static constexpr int most_pieces_a_photon = 64;  // along one path
  static constexpr float least_odds = 1.0F / 16;

  // 0 outside: photons are left as they are. `toward` points into the space that p, on a surface, looks at.
  float at(const V3f& p, const V3f& toward) const {
    const V3f x = frame.to_index(p) + frame.direction_to_local(toward) * 0.25F + V3f(0.5F, 0.5F, 0.5F);
    V3i cell;
    for (unsigned axis = 0; axis < 3; ++axis) {
      constexpr float margin = 0.25F;  // walls about the bounds belong to them
      if (!(x[axis] >= -margin && x[axis] < float(frame.size[axis]) + margin)) return 0;
      cell[axis] = std::clamp(int(x[axis]), 0, frame.size[axis] - 1);
    }
    return power_lm[frame.vertex_index(cell.x, cell.y, cell.z)];
  }
};

}  // namespace ivory
