#include "tracer/core/camera.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "grid/base/error.h"

namespace ivory {

View make_view(const std::string& file, const Camera& camera, int width, int height) {
  const M44f& m = camera.to_world;
  const V3f x(m[0][0], m[0][1], m[0][2]);
  const V3f y(m[1][0], m[1][1], m[1][2]);
  const V3f z(m[2][0], m[2][1], m[2][2]);
  const float half_height = camera.perspective ? std::tan(0.5F * camera.yfov_rad) : camera.ymag_m;
  const float volume = x.cross(y).dot(z);
  if (!std::isfinite(volume) || volume == 0 || !std::isfinite(half_height) || half_height <= 0) {
    throw Error(file, "camera '" + camera.name + "' has a singular transform or an impossible field of view",
                "choose another camera");
  }
  View view;
  view.origin = V3f(m[3][0], m[3][1], m[3][2]);
  view.right = x.normalized() * (half_height * float(width) / float(height));
  view.up = y.normalized() * half_height;
  view.forward = -z.normalized();
  view.perspective = camera.perspective;
  view.near_m = camera.near_m;
  view.far_m = camera.far_m;
  view.width = width;
  view.height = height;
  return view;
}

const Camera& find_camera(const Scene& scene, const std::string& text) {
  for (const Camera& camera : scene.cameras) {
    if (camera.name == text) return camera;
  }
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error == std::errc() && end == text.data() + text.size() && index < scene.cameras.size())
    return scene.cameras[index];
  throw ParameterError("camera", scene.name + " has no camera '" + text + "'; it has " +
                                     std::to_string(scene.cameras.size()) +
                                     (scene.cameras.size() == 1 ? " camera" : " cameras") + ", counted from 0");
}

Camera framing_camera(const V3f& center, float radius_m, float aspect) {
  Camera camera;
  camera.name = "framing";
  // The narrower of the two angles must hold the sphere: its edge rays leave at asin(radius/distance).
  const float half = std::atan(std::tan(0.5F * camera.yfov_rad) * std::min(1.0F, aspect));
  const float distance = std::max(radius_m, 1e-6F) / std::sin(half);
  const V3f z = V3f(0.45F, 0.35F, 1).normalized();
  const V3f x = V3f(0, 1, 0).cross(z).normalized();
  const V3f y = z.cross(x);
  const V3f eye = center + z * distance;
  camera.to_world = M44f(x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, eye.x, eye.y, eye.z, 1);
  return camera;
}

Ray make_ray(const View& view, const V2f& pixel) {
  const float x = 2 * pixel.x / float(view.width) - 1;
  const float y = 1 - 2 * pixel.y / float(view.height);
  const V3f offset = view.right * x + view.up * y;
  Ray ray;
  ray.cull_back_faces = true;
  ray.origin = view.perspective ? view.origin : view.origin + offset;
  ray.direction = view.perspective ? (view.forward + offset).normalized() : view.forward;
  const float cosine = view.perspective ? ray.direction.dot(view.forward) : 1.0F;
  ray.t_min = view.near_m / cosine;
  ray.t_max = view.far_m / cosine;
  return ray;
}

namespace {

bool is_single_sided(const Scene& scene, const Hit& hit) {
  const Mesh& mesh = scene.meshes[std::size_t(scene.instances[std::size_t(hit.instance)].mesh)];
  return !scene.materials[std::size_t(mesh.material)].double_sided;
}

}  // namespace

Surroundings look_around(const Intersector& intersector, const V3f& p) {
  constexpr int count = 256;
  const float golden_angle = pi * (3 - std::sqrt(5.0F));
  Surroundings around;
  for (int i = 0; i < count; ++i) {
    // Fibonacci's lattice.
    const float y = 1 - (2 * float(i) + 1) / count;
    const float r = std::sqrt(1 - y * y);
    Ray ray;
    ray.origin = p;
    ray.direction = V3f(r * std::cos(golden_angle * float(i)), y, r * std::sin(golden_angle * float(i))).normalized();
    ray.coverage_seed = std::uint32_t(i) * 0x9E3779B9U;
    const std::optional<Hit> hit = intersector.closest(ray);
    if (!hit || !(ray.direction.dot(hit->ng) > 0)) continue;
    around.back_share += 1.0 / count;
    if (is_single_sided(intersector.scene(), *hit)) around.single_sided_back_share += 1.0 / count;
  }
  return around;
}

std::optional<std::string> doubt_about(const Intersector& intersector, const View& view, const std::string& name) {
  // Walls that are cut open by their culled backs are looked at from outside: they are not all around.
  constexpr double most = 0.75;
  const double share = look_around(intersector, view.origin).single_sided_back_share;
  if (share < most) return std::nullopt;
  constexpr int side = 8;
  int backs = 0;
  for (int i = 0; i < side * side; ++i) {
    const V2f at((float(i % side) + 0.5F) / side * float(view.width),
                 (float(i / side) + 0.5F) / side * float(view.height));
    Ray ray = make_ray(view, at);
    ray.cull_back_faces = false;
    ray.coverage_seed = std::uint32_t(i) * 0x9E3779B9U;
    const std::optional<Hit> hit = intersector.closest(ray);
    if (hit && ray.direction.dot(hit->ng) > 0) ++backs;
  }
  if (backs < most * side * side) return std::nullopt;
  return fmt::format(
      "camera '{}' may stand inside a wall: {:.0f} % of what is around it are backs of single-sided surfaces", name,
      100 * share);
}

}  // namespace ivory
