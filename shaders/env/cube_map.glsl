// Faces of cube maps as grid/env/cube_map.h has them: +X, -X, +Y, -Y, +Z, -Z, seen from inside. Twin of
// grid/env/cube_map.cpp; not OpenGL's own orientation.

void ivory_cube_face_axes(int face, out vec3 forward, out vec3 right, out vec3 down) {
  float side = (face & 1) == 0 ? 1.0 : -1.0;
  if (face < 2) {
    forward = vec3(side, 0.0, 0.0);
    right = vec3(0.0, 0.0, side);
    down = vec3(0.0, -1.0, 0.0);
  } else if (face < 4) {
    forward = vec3(0.0, side, 0.0);
    right = vec3(1.0, 0.0, 0.0);
    down = vec3(0.0, 0.0, -side);
  } else {
    forward = vec3(0.0, 0.0, side);
    right = vec3(-side, 0.0, 0.0);
    down = vec3(0.0, -1.0, 0.0);
  }
}

// The face that w, of any length, leaves through, and where: s to the right, t down, each in [-1, 1].
void ivory_cube_position(vec3 w, out int face, out float s, out float t) {
  vec3 a = abs(w);
  int axis = a.x >= a.y && a.x >= a.z ? 0 : (a.y >= a.z ? 1 : 2);
  float depth = axis == 0 ? a.x : (axis == 1 ? a.y : a.z);
  float along = axis == 0 ? w.x : (axis == 1 ? w.y : w.z);
  face = 2 * axis + (along < 0.0 ? 1 : 0);
  vec3 forward, right, down;
  ivory_cube_face_axes(face, forward, right, down);
  float scale = depth > 0.0 ? 1.0 / depth : 0.0;
  s = dot(w, right) * scale;
  t = dot(w, down) * scale;
  if (depth == 0.0) face = 0;
}
