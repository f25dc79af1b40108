// Vertex stage of ivory::Renderer: meshes of runtime/renderer/mesh.h, placed.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tangent;
layout(location = 3) in vec4 uv;     // set 0, set 1
layout(location = 4) in vec4 color;  // linear RGBA

uniform mat4 ivory_clip_from_world;
uniform mat4 ivory_world_from_object;
uniform mat3 ivory_world_normal_from_object;  // inverse transpose, up to scale
uniform mat3 ivory_world_tangent_from_object;

uniform vec4 ivory_eye;  // as in renderer/surface.glsl

out vec3 ivory_p;
out vec3 ivory_from_eye;  // world, relative to the eye
out vec3 ivory_n;
out vec4 ivory_t;
out vec4 ivory_uv;
out vec4 ivory_color;

// Two passes must find the same depth.
invariant gl_Position;

void main() {
  vec4 p = ivory_world_from_object * vec4(position, 1.0);
  ivory_p = p.xyz;
  ivory_from_eye = p.xyz - ivory_eye.xyz * ivory_eye.w;
  ivory_n = ivory_world_normal_from_object * normal;
  ivory_t = vec4(ivory_world_tangent_from_object * tangent.xyz, tangent.w);
  ivory_uv = uv;
  ivory_color = color;
  gl_Position = ivory_clip_from_world * p;
}
