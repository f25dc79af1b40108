#include "grid/export/survey/thin_walls.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "grid/export/survey/plane_points.h"
#include "grid/field/guard.h"
#include "grid/field/lookup.h"

namespace ivory {

namespace {

struct Pair {
  std::size_t a = 0;
  std::size_t b = 0;
  int axis = 0;
};

std::vector<Pair> blind_pairs(const IrradianceGrid& grid, const ProbeVolume& volume) {
  std::vector<Pair> pairs;
  if (!has_planes(grid, volume)) return pairs;
  const GridFrame& frame = volume.frame;
  for (std::size_t i = 0; i < frame.vertex_count(); ++i) {
    if (volume.states[i] != ProbeState::measured) continue;
    const V3i at = frame.vertex_coordinates(i);
    for (int axis = 0; axis < 3; ++axis) {
      V3i next = at;
      next[axis] += 1;
      if (next[axis] >= frame.size[axis]) continue;
      const std::size_t other = frame.vertex_index(next.x, next.y, next.z);
      if (volume.states[other] == ProbeState::measured && !see_each_other(grid, i, other))
        pairs.push_back({i, other, axis});
    }
  }
  return pairs;
}

// Where the plane that hides `to` from `from` most crosses the line between them.
std::optional<SurfacePoint> face_between(const IrradianceGrid& grid, std::size_t from, std::size_t to) {
  const GridFrame& frame = grid.frame;
  const V3f at(frame.vertex_coordinates(from));
  const V3f step = V3f(frame.vertex_coordinates(to)) - at;
  std::optional<SurfacePoint> nearest;
  float least = 1;
  for (const std::uint32_t word : grid.guard[from].words) {
    const auto plane = unpack(word);
    if (!plane || plane->distance < 0) continue;
    const float along = plane->normal.dot(step);
    if (along <= plane->distance || plane->distance / along > least) continue;
    least = plane->distance / along;
    nearest = SurfacePoint{frame.to_world(at + step * least),
                           frame.direction_to_world(-plane->normal / frame.spacing_m).normalized()};
  }
  return nearest;
}

// Sets of pairs that touch: the same axis, and a step along another one apart.
std::vector<int> walls_of(const GridFrame& frame, const std::vector<Pair>& pairs) {
  std::map<std::pair<std::size_t, int>, int> number;
  for (std::size_t i = 0; i < pairs.size(); ++i) number[{pairs[i].a, pairs[i].axis}] = int(i);
  std::vector<int> wall(pairs.size());
  std::iota(wall.begin(), wall.end(), 0);
  const auto root = [&](int i) {
    while (wall[std::size_t(i)] != i) i = wall[std::size_t(i)] = wall[std::size_t(wall[std::size_t(i)])];
    return i;
  };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      V3i next = frame.vertex_coordinates(pairs[i].a);
      next[axis] += 1;
      if (axis == pairs[i].axis || next[axis] >= frame.size[axis]) continue;
      const auto found = number.find({frame.vertex_index(next.x, next.y, next.z), pairs[i].axis});
      if (found != number.end()) wall[std::size_t(root(found->second))] = root(int(i));
    }
  }
  for (std::size_t i = 0; i < wall.size(); ++i) wall[i] = root(int(i));
  return wall;
}

}  // namespace

bool has_planes(const IrradianceGrid& grid, const ProbeVolume& volume) {
  return !volume.resampled && !grid.guard.empty();
}

bool see_each_other(const IrradianceGrid& grid, std::size_t a, std::size_t b) {
  const V3f step(grid.frame.vertex_coordinates(b) - grid.frame.vertex_coordinates(a));
  return hidden_by(grid.guard[a], step) <= 0 && hidden_by(grid.guard[b], -step) <= 0;
}

std::size_t thin_walls(const IrradianceGrid& grid, const ProbeVolume& volume) {
  return blind_pairs(grid, volume).size();
}

std::vector<ThinWall> measure_thin_walls(const IrradianceGrid& grid, const ProbeVolume& volume,
                                         const ProbeReader& reader) {
  const std::vector<Pair> pairs = blind_pairs(grid, volume);
  const std::vector<int> wall_of = walls_of(volume.frame, pairs);
  LookupParams lookup = export_lookup(grid);
  lookup.nudge_voxels = LookupParams().nudge_voxels;
  struct Sums {
    ThinWall wall;
    V3d center{0, 0, 0};
    double squares = 0;
    int faces = 0;
  };
  std::map<int, Sums> sums;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Pair& pair = pairs[i];
    Sums& sum = sums[wall_of[i]];
    const V3f& h = volume.frame.spacing_m;
    sum.wall.axis = pair.axis;
    sum.wall.area_m2 += double(h[(pair.axis + 1) % 3]) * double(h[(pair.axis + 2) % 3]);
    ++sum.wall.pairs;
    const auto place = [&](std::size_t probe) {
      return volume.frame.to_world(V3f(volume.frame.vertex_coordinates(probe)));
    };
    sum.center += V3d(place(pair.a) + place(pair.b)) * 0.5;
    for (const auto& [from, to] : {std::pair(pair.a, pair.b), std::pair(pair.b, pair.a)}) {
      const std::optional<SurfacePoint> face = face_between(grid, from, to);
      if (!face) continue;
      const Rgb known = lookup_irradiance(grid, face->p, face->n, face->n, lookup);
      const Rgb shown = reader(face->p, face->n);
      const double off = (double(shown.x) - known.x + shown.y - known.y + shown.z - known.z) / 3;
      sum.squares += off * off;
      ++sum.faces;
      sum.wall.brightest_lux = std::max(sum.wall.brightest_lux, off);
      sum.wall.darkest_lux = std::min(sum.wall.darkest_lux, off);
    }
  }
  std::vector<ThinWall> walls;
  for (auto& [number, sum] : sums) {
    sum.wall.center = V3f(sum.center / double(sum.wall.pairs));
    sum.wall.rms_lux = sum.faces > 0 ? std::sqrt(sum.squares / sum.faces) : 0;
    walls.push_back(sum.wall);
  }
  std::stable_sort(walls.begin(), walls.end(), [](const ThinWall& a, const ThinWall& b) {
    return std::max(a.brightest_lux, -a.darkest_lux) > std::max(b.brightest_lux, -b.darkest_lux);
  });
  return walls;
}

}  // namespace ivory
