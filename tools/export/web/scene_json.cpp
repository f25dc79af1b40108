#include "tools/export/web/scene_json.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <nlohmann/json.hpp>

#include "grid/base/anchor.h"
#include "tracer/core/camera.h"
#include "tracer/core/film.h"
#include "tracer/render/final_gather.h"
#include "tracer/render/render.h"

namespace ivory {

namespace {

using Json = nlohmann::ordered_json;

constexpr int film_width = 64;
constexpr int film_height = 48;

template <typename Vector>
Json list_of(const Vector& v) {
  return {v.x, v.y, v.z};
}

std::vector<Camera> cameras_of(const LitScene& lit) {
  std::vector<Camera> cameras;
  for (const Camera& camera : lit.scene->cameras)
    if (camera.perspective) cameras.push_back(camera);
  if (cameras.empty()) {
    cameras.push_back(
        framing_camera(lit.intersector.center(), lit.intersector.radius_m(), float(film_width) / film_height));
    cameras.back().name = "all";
  }
  return cameras;
}

}  // namespace

Json views_json(const LitScene& lit) {
  Json views = Json::array();
  const V3d& anchor = lit.scene->anchor_m;
  for (const Camera& camera : cameras_of(lit)) {
    const View view = make_view(lit.scene->name, camera, film_width, film_height);
    Ray ray{.origin = view.origin, .direction = view.forward, .t_min = view.near_m};
    ray.blocking_coverage = half_coverage;
    const auto hit = lit.intersector.closest(ray);
    // What it is turned about lies on what it looks at.
    const float distance = hit ? hit->t : std::max(lit.intersector.radius_m(), 1e-3F);
    const bool upright = std::abs(view.forward.y) < 0.999F;
    views.push_back({{"name", camera.name.empty() ? "camera " + std::to_string(views.size()) : camera.name},
                     {"position", list_of(to_world(view.origin, anchor))},
                     {"target", list_of(to_world(view.origin + view.forward * distance, anchor))},
                     {"up", list_of(upright ? V3f(0, 1, 0) : view.up.normalized())},
                     {"yfov_deg", 2 * std::atan(double(view.up.length())) * 180 / double(pi)}});
  }
  return views;
}

Json lamps_json(const Scene& scene, const IrradianceGrid& grid) {
  std::istringstream groups(find_text(grid.metadata, lamp_groups_key).value_or(""));
  Json lamps = Json::array();
  for (const int node : scene.light_nodes) {
    std::string group;
    groups >> group;
    lamps.push_back({{"node", node}, {"group", group}});
  }
  return lamps;
}

Json spheres_json(const Scene& scene) {
  Json spheres = Json::array();
  for (const SphereLight& sphere : scene.sphere_lights) {
    spheres.push_back({{"center", list_of(to_world(sphere.center, scene.anchor_m))},
                       {"radius", sphere.radius_m},
                       {"radiance", list_of(sphere.radiance_nits)}});
  }
  return spheres;
}

double page_exposure(const LitScene& lit, const IrradianceGrid& grid) {
  const View view = make_view(lit.scene->name, cameras_of(lit).front(), film_width, film_height);
  GatherParams params;
  params.indirect_only = grid.light == StoredLight::direct_and_indirect;
  const GridLight light{&grid, LookupParams{.guard = Guard::rays}};
  RenderParams render;
  render.samples = 8;
  return std::exp2(double(auto_exposure(render_gather(lit, indirect_light(lit, light), view, render, params))));
}

ErrorMap make_error_map(const ReaderSurvey& survey, const V3d& anchor_m) {
  ErrorMap map;
  Box3f box;
  std::vector<double> off;
  for (const SurveyPoint& point : survey.points) {
    box.extendBy(point.at.p);
    off.push_back(std::abs(off_by(point, survey.mean_lux)));
  }
  if (off.empty()) return map;
  // All but the worst fiftieth lie within the colours.
  std::ranges::sort(off);
  const double most = off[off.size() * 49 / 50];
  for (const double full : {0.02, 0.05, 0.1, 0.2, 0.5, 1.0}) {
    map.full = full;
    if (full >= most) break;
  }
  map.low = to_world(box.min, anchor_m);
  map.extent = V3d(box.max - box.min);
  for (const SurveyPoint& point : survey.points) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      const double extent = std::max(map.extent[axis], 1e-9);
      const double t = std::clamp(double(point.at.p[axis] - box.min[axis]) / extent, 0.0, 1.0);
      const auto step = std::uint16_t(std::lround(65535 * t));
      map.bytes.push_back(char(step & 0xFFU));
      map.bytes.push_back(char(step >> 8U));
    }
    for (unsigned axis = 0; axis < 3; ++axis) map.bytes.push_back(char(std::lround(127 * point.at.n[axis])));
    const double share = std::clamp(off_by(point, survey.mean_lux) / map.full, -1.0, 1.0);
    map.bytes.push_back(char(std::lround(127 * share)));
  }
  return map;
}

}  // namespace ivory
