#include "tracer/core/camera.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "grid/base/error.h"

namespace ivory {

View make_view(const std::string& file, const Camera& camera, int width, int height) {
  const M44f& m = camera.to_world;
  const V3f x(m[0][0], m[0][1], m[0][2]);
  const V3f y(m[1][0], m[1][1], m[1][2]);
  const V3f z(m[2][0], m[2][1], m[2][2]);
  const float half_height = camera.perspective ? std::tan(0.5F * camera.yfov_rad) : camera.ymag_m;
  const float volume = x.cross(y).dot(z);
  if (!std::isfinite(volume) || volume == 0 || !std::isfinite(half_height) || half_height <= 0)
    throw Error(file, "camera '" + camera.name + "' has a singular transform or an impossible field of view",
                "choose another camera");
  View view;
  view.origin = V3f(m[3][0], m[3][1], m[3][2]);
  view.right = x.normalized() * (half_height * float(width) / float(height));
  view.up = y.normalized() * half_height;
  view.forward = -z.normalized();
  view.perspective = camera.perspective;
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
  return ray;
}

}  // namespace ivory
