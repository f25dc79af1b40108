#include "tools/export/scene_survey.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "grid/base/counted_random.h"
#include "tracer/render/guard_rays.h"

namespace ivory {

namespace {

// A triangle's side in the world.
struct Side {
  std::array<V3f, 3> corners;
  V3f n;
};

struct Sides {
  std::vector<Side> list;
  std::vector<double> area_until;  // m^2, up to and including each
};

Sides seen_sides(const Scene& scene, const GridFrame& frame) {
  Sides sides;
  double area = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    const bool both = scene.materials[std::size_t(mesh.material)].double_sided;
    const float sign = instance.to_world.determinant() < 0 ? -1.0F : 1.0F;
    for (const auto& t : mesh.triangles) {
      Side side;
      for (unsigned i = 0; i < 3; ++i) instance.to_world.multVecMatrix(mesh.positions[t[i]], side.corners[i]);
      // Those that lie wholly beyond the grid have no say.
      const auto outside = [&](int axis, float sense) {
        return std::ranges::all_of(side.corners, [&](const V3f& corner) {
          const float index = frame.to_index(corner)[axis];
          return sense < 0 ? index < -0.501F : index > float(frame.size[axis]) - 0.499F;
        });
      };
      bool beyond = false;
      for (int axis = 0; axis < 3; ++axis) beyond = beyond || outside(axis, -1) || outside(axis, 1);
      if (beyond) continue;
      const V3f cross = (side.corners[1] - side.corners[0]).cross(side.corners[2] - side.corners[0]);
      if (!(cross.length() > 0)) continue;
      side.n = cross.normalized() * sign;
      for (int k = 0; k < (both ? 2 : 1); ++k) {
        sides.list.push_back(side);
        sides.area_until.push_back(area += 0.5 * double(cross.length()));
        side.n = -side.n;
      }
    }
  }
  return sides;
}

}  // namespace

SceneInput load_scene_of_grid(const std::string& path, IrradianceGrid& grid, const CommonOptions& common) {
  SceneOptions options;
  options.load.scale = find_number(grid.metadata, "scene_scale").value_or(1);
  options.load.time_s = find_number(grid.metadata, "time_s");
  options.load.animation = find_text(grid.metadata, "animation").value_or("");
  std::string without = find_text(grid.metadata, "without").value_or("");
  for (std::size_t end = 0; !without.empty(); without.erase(0, end + 2)) {
    end = std::min(without.find(", "), without.size());
    options.load.without.push_back(without.substr(0, end));
    if (end == without.size()) break;
  }
  SceneInput input = load_scene_input(path, options, {}, common);
  if (const auto hash = find_text(grid.metadata, "scene_hash"); hash && *hash != input.lit.scene->content_hash) {
    print_note(common, fmt::format("note: the grid was baked from another scene ({})",
                                   find_text(grid.metadata, "scene").value_or("")));
  }
  set_anchor(grid, input.lit.scene->anchor_m);
  return input;
}

SceneSurvey survey_scene(const Scene& scene, const Intersector& intersector, const IrradianceGrid& grid,
                         const ProbeReader& reader, int points, float apart_m, std::uint64_t seed) {
  const Sides sides = seen_sides(scene, grid.frame);
  SceneSurvey out;
  if (sides.list.empty()) return out;
  const LookupParams lookup{.guard = Guard::rays};
  std::vector<SurveyPoint> found;
  constexpr std::uint64_t tries_a_point = 4;
  constexpr std::uint64_t numbers_a_try = 4;
  std::uint64_t tries = 0;
  std::uint64_t covered = 0;
  for (; tries < std::uint64_t(points) * tries_a_point && found.size() < std::size_t(points); ++tries) {
    const auto uniform = [&](std::uint64_t k) { return counted_uniform(seed, numbers_a_try * tries + k); };
    const auto at = std::ranges::upper_bound(sides.area_until, uniform(0) * sides.area_until.back());
    const Side& side = sides.list[std::min(std::size_t(at - sides.area_until.begin()), sides.list.size() - 1)];
    const float root = std::sqrt(float(uniform(1)));
    const float b = root * (1 - float(uniform(2)));
    const float c = root - b;
    const V3f p = side.corners[0] * (1 - root) + side.corners[1] * b + side.corners[2] * c;
    if (!grid.frame.covers(p)) continue;
    ++covered;
    const Footprint footprint = lookup_footprint(grid, &intersector, p, side.n, lookup);
    if (footprint.count == 0) continue;
    found.push_back({{p, side.n}, reader(p, side.n), irradiance(grid, footprint, side.n, Reconstruction::optimal)});
  }
  out.area_m2 = sides.area_until.back() * double(covered) / double(std::max<std::uint64_t>(tries, 1));
  out.survey = make_survey(std::move(found), apart_m);
  return out;
}

}  // namespace ivory
