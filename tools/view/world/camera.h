// The viewer's camera: an ordinary scene camera that orbits, looks around, flies and comes closer. It keeps to the
// pixel where the scene's camera stands until it is moved.
#pragma once

#include "tracer/core/scene.h"

namespace ivory {

struct ViewCamera {
  Camera camera;
  float pivot_distance_m = 1;  // to the point ahead that orbit() turns about
};

V3f eye(const ViewCamera& view);
V3f forward(const ViewCamera& view);  // unit
V3f pivot(const ViewCamera& view);

// Looks along the camera, turning about the point at the scene's middle depth. `center`, `radius_m`: sphere around
// the scene.
ViewCamera make_view_camera(const Camera& camera, const V3f& center, float radius_m);

// Turns eye and axes about the pivot: by yaw about the world's +Y (positive: the eye moves to its right, the scene
// turns to the left), then by pitch about the horizontal (positive: the eye rises). The pitch stops short of the poles.
ViewCamera orbit(const ViewCamera& view, float yaw_rad, float pitch_rad);
// The same turns about the eye: positive yaw looks to the left, positive pitch up.
ViewCamera look(const ViewCamera& view, float yaw_rad, float pitch_rad);
// Moves the eye, along its own axes: x right, y up, z forward.
ViewCamera fly(const ViewCamera& view, const V3f& by_m);
// Brings the eye to `factor` of its distance from the pivot; an orthographic view shows `factor` of what it showed.
ViewCamera dolly(const ViewCamera& view, float factor);
// Aims at the sphere from where the camera looks now, all of it in view.
ViewCamera frame_sphere(const ViewCamera& view, const V3f& center, float radius_m, float aspect);

// What rasterisation takes, for Imath row vectors: p_clip = p_world * world_to_eye * projection, OpenGL's clip space.
struct ViewMatrices {
  M44f world_to_eye;
  M44f projection;
};

// Pixel for pixel the rays of make_view() and make_ray(). `shift` moves the picture by that part of a pixel, x right,
// y down, so that the ray of the pixel's point (0.5, 0.5) - shift passes through its centre. Near and far planes
// enclose the sphere. Throws Error (naming `file`) as make_view() does.
ViewMatrices view_matrices(const std::string& file, const Camera& camera, int width, int height, const V2f& shift,
                           const V3f& center, float radius_m);

}  // namespace ivory
