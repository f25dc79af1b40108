#include "tracer/render/photons/aim.h"

#include <algorithm>
#include <cmath>

#include "grid/base/types.h"

namespace ivory {

AimedBox aim(const PhotonAim& aim, const V3f& p) {
  AimedBox box;
  const GridFrame& frame = aim.frame;
  box.extent_m = V3f(frame.size) * frame.spacing_m;
  box.p = frame.direction_to_local(p - frame.origin_m) + frame.spacing_m * 0.5F;
  // Ground that the box stands on does not see its bottom, whatever rounding says.
  const float margin = 1e-3F * box.extent_m.length();
  for (unsigned axis = 0; axis < 3; ++axis) {
    const bool below = box.p[axis] < -margin;
    const bool above = box.p[axis] > box.extent_m[axis] + margin;
    if (!below && !above) continue;
    box.upper[axis] = above;
    box.face_m2[axis] = box.extent_m[(axis + 1) % 3] * box.extent_m[(axis + 2) % 3];
    box.area_m2 += box.face_m2[axis];
    // As if the face lay in its middle, at least its own width away.
    const float off = above ? box.p[axis] - box.extent_m[axis] : -box.p[axis];
    V3f d = box.extent_m * 0.5F - box.p;
    d[axis] = off;
    const float r2 = d.length2() + box.face_m2[axis] / (2 * pi);
    box.solid_angle += box.face_m2[axis] * off / (r2 * std::sqrt(r2));
  }
  box.solid_angle = std::min(box.solid_angle, 2 * pi);
  return box;
}

V3f sample(const PhotonAim& aim, const AimedBox& box, float u_face, const V2f& u) {
  float at = u_face * box.area_m2;
  unsigned axis = 0;
  for (unsigned a = 0; a < 3; ++a) {
    if (box.face_m2[a] == 0) continue;
    axis = a;
    if (at < box.face_m2[a]) break;
    at -= box.face_m2[a];
  }
  V3f q;
  q[axis] = box.upper[axis] ? box.extent_m[axis] : 0.0F;
  q[(axis + 1) % 3] = u.x * box.extent_m[(axis + 1) % 3];
  q[(axis + 2) % 3] = u.y * box.extent_m[(axis + 2) % 3];
  return aim.frame.direction_to_world(q - box.p).normalized();
}

// Evenly over the area A of the faces: r^2 / (A cos) at the one point where w enters through them. cos > 0 there.
float pdf_solid_angle(const PhotonAim& aim, const AimedBox& box, const V3f& w) {
  const V3f d = aim.frame.direction_to_local(w);
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (box.face_m2[axis] == 0) continue;
    const float to = (box.upper[axis] ? box.extent_m[axis] : 0.0F) - box.p[axis];
    if (!(to * d[axis] > 0)) continue;
    const float r = to / d[axis];
    const unsigned b = (axis + 1) % 3;
    const unsigned c = (axis + 2) % 3;
    const float at_b = box.p[b] + r * d[b];
    const float at_c = box.p[c] + r * d[c];
    // What was sampled at a rim belongs to its face, whatever rounding says.
    const float hair = 1e-6F * r;
    if (at_b < -hair || at_b > box.extent_m[b] + hair || at_c < -hair || at_c > box.extent_m[c] + hair) continue;
    return r * r / (box.area_m2 * std::abs(d[axis]));
  }
  return 0;
}

}  // namespace ivory
