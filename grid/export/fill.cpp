#include "grid/export/fill.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>

#include "grid/env/sh9.h"
#include "grid/field/guard.h"

namespace ivory {

namespace {

struct Neighbour {
  std::size_t probe = 0;
  V3i step;          // from the probe that is filled, -1 to 1 along each axis
  V3f direction;     // unit, world
  float weight = 0;  // trust / distance^2, 1/m^2
  int room = 0;
};

bool see_each_other(std::span<const GuardRecord> guard, std::size_t a, std::size_t b, const V3i& a_to_b) {
  return guard.empty() || (hidden_by(guard[a], V3f(a_to_b)) <= 0 && hidden_by(guard[b], V3f(-a_to_b)) <= 0);
}

class Neighbours {
 public:
  Neighbours(const ProbeVolume& volume, std::span<const GuardRecord> guard, std::size_t probe) {
    const GridFrame& frame = volume.frame;
    const V3i at = frame.vertex_coordinates(probe);
    for (int i = 0; i < 27; ++i) {
      const V3i step(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      const V3i there = at + step;
      bool inside = step != V3i(0, 0, 0);
      for (int axis = 0; axis < 3; ++axis) inside = inside && there[axis] >= 0 && there[axis] < frame.size[axis];
      if (!inside) {
        is_outermost_ = is_outermost_ || step != V3i(0, 0, 0);
        continue;
      }
      const std::size_t other = frame.vertex_index(there.x, there.y, there.z);
      if (volume.states[other] != ProbeState::measured) continue;
      const V3f offset = frame.direction_to_world(frame.spacing_m * V3f(step));
      list_[std::size_t(count_)] = {other, step, offset.normalized(), volume.trust[other] / offset.length2(), count_};
      ++count_;
    }
    // Rooms: those that a step joins through which they see each other. A few passes settle 26 of them.
    for (bool changed = true; changed;) {
      changed = false;
      for (int a = 0; a < count_; ++a) {
        for (int b = 0; b < a; ++b) {
          Neighbour& first = list_[std::size_t(a)];
          Neighbour& second = list_[std::size_t(b)];
          const V3i between = second.step - first.step;
          if (first.room == second.room ||
              std::max({std::abs(between.x), std::abs(between.y), std::abs(between.z)}) > 1)
            continue;
          if (!see_each_other(guard, first.probe, second.probe, between)) continue;
          const int room = std::min(first.room, second.room);
          first.room = second.room = room;
          changed = true;
        }
      }
    }
  }

  std::span<const Neighbour> list() const { return {list_.data(), std::size_t(count_)}; }
  bool is_outermost() const { return is_outermost_; }

 private:
  std::array<Neighbour, 26> list_;
  int count_ = 0;
  bool is_outermost_ = false;
};

// The rooms' means of one side, mixed. Nothing where no neighbour has a weight.
template <typename Weight>
bool mix_rooms(const ProbeVolume& volume, std::span<const Neighbour> neighbours, std::size_t side, const Weight& weight,
               Rgb& out) {
  std::array<V3d, 26> sum;
  std::array<double, 26> total{};
  sum.fill(V3d(0, 0, 0));
  for (const Neighbour& neighbour : neighbours) {
    const double w = weight(neighbour);
    sum[std::size_t(neighbour.room)] += V3d(volume.sides[neighbour.probe][side]) * w;
    total[std::size_t(neighbour.room)] += w;
  }
  double brightest = 0;
  for (std::size_t room = 0; room < 26; ++room) {
    if (total[room] <= 0) continue;
    sum[room] /= total[room];
    brightest = std::max(brightest, sum[room].x + sum[room].y + sum[room].z);
  }
  V3d mean(0, 0, 0);
  double weights = 0;
  for (std::size_t room = 0; room < 26; ++room) {
    if (total[room] <= 0) continue;
    const double light = std::max(sum[room].x + sum[room].y + sum[room].z, 1e-6 * brightest);
    const double w = light > 0 ? total[room] / (light * light) : 1;
    mean += sum[room] * w;
    weights += w;
  }
  if (!(weights > 0)) return false;
  out = Rgb(mean / weights);
  return true;
}

SixSides fill_from(const ProbeVolume& volume, const Neighbours& neighbours) {
  SixSides sides;
  sides.fill(Rgb(0, 0, 0));
  for (std::size_t side = 0; side < 6; ++side) {
    const auto in_front = [&](const Neighbour& neighbour) {
      const float cosine = std::max(0.0F, neighbour.direction.dot(side_normal(side)));
      // Right angles to rounding are right angles.
      return cosine < 1e-3F ? 0.0 : double(neighbour.weight * cosine * cosine);
    };
    if (mix_rooms(volume, neighbours.list(), side, in_front, sides[side])) continue;
    if (neighbours.is_outermost()) {
      mix_rooms(
          volume, neighbours.list(), side, [](const Neighbour& n) { return double(n.weight); }, sides[side]);
    }
  }
  return sides;
}

}  // namespace

ProbeSh9 sh9_of_sides(const SixSides& sides) {
  const auto mean = [&](std::size_t axis) { return (V3d(sides[2 * axis]) + V3d(sides[2 * axis + 1])) * 0.5; };
  const auto difference = [&](std::size_t axis) { return (V3d(sides[2 * axis]) - V3d(sides[2 * axis + 1])) * 0.5; };
  // E(n) = e0 + v . n + q20 (3 z^2 - 1) + q22 (x^2 - y^2) at the six axes, solved.
  const V3d e0 = (mean(0) + mean(1) + mean(2)) / 3;
  std::array<V3d, 9> e;
  e.fill(V3d(0, 0, 0));
  e[0] = e0;
  e[1] = difference(1);
  e[2] = difference(2);
  e[3] = difference(0);
  e[6] = (mean(2) - e0) * 0.5;
  e[8] = (mean(0) - mean(1)) * 0.5;
  ProbeSh9 sh;
  for (std::size_t i = 0; i < 9; ++i) sh[i] = V3f(e[i] / (sh9_cosine[i] * sh9_factor[i]));
  return sh;
}

void fill_unknown(ProbeVolume& volume, std::span<const GuardRecord> guard) {
  // All read what was measured, and what they are given is put in place after that.
  struct Given {
    SixSides sides;
    bool any = false;
  };
  std::vector<Given> given(volume.sides.size());
  tbb::parallel_for(std::size_t(0), given.size(), [&](std::size_t i) {
    const bool is_measured = volume.states[i] == ProbeState::measured;
    if (is_measured && volume.trust[i] >= 1) return;
    const Neighbours neighbours(volume, guard, i);
    if (!is_measured) {
      if (!neighbours.list().empty()) given[i] = {fill_from(volume, neighbours), true};
      return;
    }
    const auto seen = [&](const Neighbour& n) {
      return see_each_other(guard, i, n.probe, n.step) ? double(n.weight) : 0.0;
    };
    for (std::size_t side = 0; side < 6; ++side) {
      if (!mix_rooms(volume, neighbours.list(), side, seen, given[i].sides[side])) return;
    }
    given[i].any = true;
  });
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (!given[i].any) continue;
    // Its own light by its trust, which is 0 where it knows none.
    const float own = volume.trust[i];
    for (std::size_t side = 0; side < 6; ++side)
      volume.sides[i][side] = volume.sides[i][side] * own + given[i].sides[side] * (1 - own);
    if (volume.states[i] == ProbeState::dark) volume.states[i] = ProbeState::filled;
    if (volume.sh.empty()) continue;
    const ProbeSh9 by_sides = sh9_of_sides(given[i].sides);
    for (std::size_t k = 0; k < 9; ++k) volume.sh[i][k] = volume.sh[i][k] * own + by_sides[k] * (1 - own);
  }
}

}  // namespace ivory
