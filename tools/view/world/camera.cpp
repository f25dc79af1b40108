#include "tools/view/world/camera.h"

#include <algorithm>
#include <cmath>

#include "tracer/core/camera.h"

namespace ivory {

namespace {

const V3f world_up(0, 1, 0);

V3f axis(const Camera& camera, int row) {
  const float* m = camera.to_world[row];
  return V3f(m[0], m[1], m[2]).normalized();
}

// Turns the camera's axes and its place about `center`.
void rotate(Camera& camera, const V3f& center, const V3f& about, float angle_rad) {
  M44f turn;
  turn.setAxisAngle(about, angle_rad);
  M44f to;
  to.setTranslation(-center);
  M44f back;
  back.setTranslation(center);
  camera.to_world = camera.to_world * to * turn * back;
}

// Horizontal axis to the right of the view; the camera's own where it looks straight up or down.
V3f horizontal(const Camera& camera) {
  const V3f side = (-axis(camera, 2)).cross(world_up);
  return side.length() > 1e-4F ? side.normalized() : axis(camera, 0);
}

// The pitch that leaves the view two degrees short of straight up and down, where yaw and pitch would be one. A scene's
// camera may start beyond: it only comes back.
float held_pitch(const Camera& camera, float pitch_rad) {
  constexpr float limit = pi / 2 - 2 * pi / 180;
  const float now = std::asin(std::clamp(-axis(camera, 2).y, -1.0F, 1.0F));
  const float most = std::max(0.0F, limit - now);
  const float least = std::min(0.0F, -limit - now);
  return std::clamp(pitch_rad, least, most);
}

void set_eye(Camera& camera, const V3f& eye) {
  for (unsigned c = 0; c < 3; ++c) camera.to_world[3][c] = eye[c];
}

}  // namespace

V3f eye(const ViewCamera& view) {
  const float* m = view.camera.to_world[3];
  return {m[0], m[1], m[2]};
}

V3f forward(const ViewCamera& view) { return -axis(view.camera, 2); }

V3f pivot(const ViewCamera& view) { return eye(view) + forward(view) * view.pivot_distance_m; }

ViewCamera make_view_camera(const Camera& camera, const V3f& center, float radius_m) {
  ViewCamera view{camera, 1};
  // Inside a room its middle may lie behind; then a point some way ahead.
  const float depth = (center - eye(view)).dot(forward(view));
  view.pivot_distance_m = std::max({depth, 0.25F * radius_m, 1e-6F});
  return view;
}

ViewCamera orbit(const ViewCamera& view, float yaw_rad, float pitch_rad) {
  ViewCamera turned = view;
  const V3f about = pivot(view);
  rotate(turned.camera, about, world_up, yaw_rad);
  // The eye rises as the view tilts down.
  rotate(turned.camera, about, horizontal(turned.camera), held_pitch(turned.camera, -pitch_rad));
  return turned;
}

ViewCamera look(const ViewCamera& view, float yaw_rad, float pitch_rad) {
  ViewCamera turned = view;
  rotate(turned.camera, eye(view), world_up, yaw_rad);
  rotate(turned.camera, eye(view), horizontal(turned.camera), held_pitch(turned.camera, pitch_rad));
  return turned;
}

ViewCamera fly(const ViewCamera& view, const V3f& by_m) {
  ViewCamera moved = view;
  set_eye(moved.camera,
          eye(view) + axis(view.camera, 0) * by_m.x + axis(view.camera, 1) * by_m.y + forward(view) * by_m.z);
  return moved;
}

ViewCamera dolly(const ViewCamera& view, float factor) {
  ViewCamera moved = view;
  const float distance = std::max(view.pivot_distance_m * factor, 1e-6F);
  set_eye(moved.camera, pivot(view) - forward(view) * distance);
  moved.pivot_distance_m = distance;
  if (!moved.camera.perspective) moved.camera.ymag_m = std::max(moved.camera.ymag_m * factor, 1e-6F);
  return moved;
}

ViewCamera frame_sphere(const ViewCamera& view, const V3f& center, float radius_m, float aspect) {
  ViewCamera moved = view;
  const float radius = std::max(radius_m, 1e-6F);
  const float half = std::atan(std::tan(0.5F * view.camera.yfov_rad) * std::min(1.0F, aspect));
  moved.pivot_distance_m = view.camera.perspective ? radius / std::sin(half) : 2 * radius;
  set_eye(moved.camera, center - forward(view) * moved.pivot_distance_m);
  if (!view.camera.perspective) moved.camera.ymag_m = radius / std::min(1.0F, aspect);
  // All of the sphere is to be seen.
  moved.camera.near_m = 0;
  moved.camera.far_m = std::numeric_limits<float>::infinity();
  return moved;
}

ViewMatrices view_matrices(const std::string& file, const Camera& camera, int width, int height, const V2f& shift,
                           const V3f& center, float radius_m) {
  const View v = make_view(file, camera, width, height);
  // make_view() takes each axis by itself, so that they need not be at right angles: a point is
  // eye + x right^ + y up^ - z forward^, and the inverse of that map gives x, y and z.
  const V3f x = v.right.normalized();
  const V3f y = v.up.normalized();
  const V3f z = -v.forward;
  const M44f from_eye(x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, v.origin.x, v.origin.y, v.origin.z, 1);
  ViewMatrices m;
  m.world_to_eye = from_eye.inverse();

  const float middle = (center - v.origin).dot(v.forward);
  const float margin = 1.01F * radius_m + 1e-6F;
  const float far = std::min(std::max(middle + margin, 2e-6F), camera.far_m);
  // A thousandth of the far plane's distance leaves 24 bits of depth a step of 1e-4 of the depth there. A camera's own
  // near plane may lie behind all that there is.
  const float least = v.perspective ? std::max(middle - margin, 1e-3F * far) : middle - margin;
  const float near = std::min(std::max(least, camera.near_m), far - 1e-3F * std::abs(far));
  const float half_width = v.right.length();
  const float half_height = v.up.length();
  const float dx = 2 * shift.x / float(width);
  const float dy = -2 * shift.y / float(height);
  const float depth = far - near;
  if (v.perspective) {
    // Rows are what multiplies x, y, z and 1 of the eye's space; w_clip = -z. A shift of the picture is one of x_clip /
    // w_clip.
    m.projection = M44f(1 / half_width, 0, 0, 0, 0, 1 / half_height, 0, 0, -dx, -dy, -(far + near) / depth, -1, 0, 0,
                        -2 * far * near / depth, 0);
  } else {
    m.projection =
        M44f(1 / half_width, 0, 0, 0, 0, 1 / half_height, 0, 0, 0, 0, -2 / depth, 0, dx, dy, -(far + near) / depth, 1);
  }
  return m;
}

}  // namespace ivory
