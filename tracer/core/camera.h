// From the cameras of a scene to rays through pixels.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "tracer/core/intersector.h"

namespace ivory {

// A camera and an image size, ready to make rays. World space.
struct View {
  V3f origin;
  V3f right;         // from the image's centre to its right edge, at unit distance; orthographic: in metres
  V3f up;            // from its centre to its top edge, likewise
  V3f forward;       // unit
  float near_m = 0;  // along `forward`, as the camera's
  float far_m = std::numeric_limits<float>::infinity();
  bool perspective = true;
  int width = 1;  // pixels
  int height = 1;
};

// The camera's vertical field of view is kept and pixels are square; a scale in its transform is ignored.
// Throws Error (naming `file`) where the camera's transform or angle makes no picture.
View make_view(const std::string& file, const Camera& camera, int width, int height);

// The scene's camera of that index ("0") or name. Throws ParameterError where there is none.
const Camera& find_camera(const Scene& scene, const std::string& index_or_name);

// A perspective camera that sees the whole sphere (world, metres) from the front, a little from above and the right.
// `aspect` is the image's width over its height.
Camera framing_camera(const V3f& center, float radius_m, float aspect);

// Ray through `pixel`: continuous, x from 0 (left) to width, y from 0 (top) to height. An eye ray:
// it culls back faces as glTF asks, and passes what lies before the camera's near plane and behind its far plane.
Ray make_ray(const View& view, const V2f& pixel);

// What is all around a point, as shares of 256 directions evenly over the sphere: those whose first surface shows its
// back, as nearly all do from inside of a solid.
struct Surroundings {
  double back_share = 0;
  double single_sided_back_share = 0;  // of materials whose backs the eye does not see
};
Surroundings look_around(const Intersector& intersector, const V3f& p);

// Does the camera look out of a solid, by the backs of single-sided surfaces around it and behind its near plane? A
// line that says so, or nothing.
std::optional<std::string> doubt_about(const Intersector& intersector, const View& view, const std::string& name);

}  // namespace ivory
