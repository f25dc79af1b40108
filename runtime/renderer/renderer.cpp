#include "runtime/renderer/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "grid/base/placement.h"
#include "runtime/gl/check.h"

namespace ivory {

namespace {

constexpr const char* sky_vertex = R"(
out vec2 ndc;
void main() {
  ndc = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(ndc, 1.0, 1.0);
}
)";
constexpr const char* sky_fragment = R"(
#include "env/sky.glsl"
uniform mat4 world_from_clip;
uniform sampler2D sky;
uniform float scale;
uniform mat3 from_world;
in vec2 ndc;
out vec4 fragment;
void main() {
  vec4 near = world_from_clip * vec4(ndc, -1.0, 1.0);
  vec4 far = world_from_clip * vec4(ndc, 1.0, 1.0);
  vec3 w = normalize(far.xyz / far.w - near.xyz / near.w);
  fragment = vec4(ivory_sky(sky, from_world * w) * scale, 1.0);
}
)";

M44f view_from_world(const M44f& to_world) {
  const V3f x = V3f(to_world[0][0], to_world[0][1], to_world[0][2]).normalized();
  const V3f y = V3f(to_world[1][0], to_world[1][1], to_world[1][2]).normalized();
  const V3f z = V3f(to_world[2][0], to_world[2][1], to_world[2][2]).normalized();
  const V3f eye(to_world[3][0], to_world[3][1], to_world[3][2]);
  return {x.x, y.x, z.x, 0, x.y, y.y, z.y, 0, x.z, y.z, z.z, 0, -x.dot(eye), -y.dot(eye), -z.dot(eye), 1};
}

RuntimeCamera camera_with(const M44f& to_world, const M44f& projection, bool is_perspective) {
  RuntimeCamera camera;
  camera.clip_from_world = view_from_world(to_world) * projection;
  camera.position_m = V3f(to_world[3][0], to_world[3][1], to_world[3][2]);
  camera.perspective = is_perspective;
  camera.forward = -V3f(to_world[2][0], to_world[2][1], to_world[2][2]).normalized();
  return camera;
}

M33f linear_part(const M44f& m) {
  return {m[0][0], m[0][1], m[0][2], m[1][0], m[1][1], m[1][2], m[2][0], m[2][1], m[2][2]};
}

// The cofactors: the inverse transpose times the determinant, whose sign is taken out again.
M33f normal_matrix(const M33f& m) {
  const V3f x(m[0][0], m[0][1], m[0][2]);
  const V3f y(m[1][0], m[1][1], m[1][2]);
  const V3f z(m[2][0], m[2][1], m[2][2]);
  const V3f yz = y.cross(z);
  const V3f zx = z.cross(x);
  const V3f xy = x.cross(y);
  const float sign = x.dot(yz) < 0 ? -1.0F : 1.0F;
  return {sign * yz.x, sign * yz.y, sign * yz.z, sign * zx.x, sign * zx.y,
          sign * zx.z, sign * xy.x, sign * xy.y, sign * xy.z};
}

void set_camera(gl::Program& program, const RuntimeCamera& camera) {
  program.set("ivory_clip_from_world", camera.clip_from_world);
  const V3f eye = camera.perspective ? camera.position_m : -camera.forward;
  program.set("ivory_eye", V4f(eye.x, eye.y, eye.z, camera.perspective ? 1.0F : 0.0F));
}

// Sets what belongs to the item and draws it.
void draw_item(gl::Program& program, const DrawItem& item, int first_unit) {
  const M33f linear = linear_part(item.to_world);
  const float handedness = linear.determinant() < 0 ? -1.0F : 1.0F;
  program.set("ivory_world_from_object", item.to_world);
  program.set("ivory_world_normal_from_object", normal_matrix(linear));
  program.set("ivory_world_tangent_from_object", linear);
  const SurfaceMaterial& material = *item.material;
  const bool mapped = material.normal_texture.texture != nullptr && item.mesh->has_tangents;
  program.set("ivory_shading",
              V4f(material.normal_scale, item.mesh->has_normals ? 1.0F : 0.0F, mapped ? 1.0F : 0.0F, handedness));
  bind(material, program, first_unit);
  // Back faces of single-sided materials are not seen; a mirror turns triangles around.
  if (material.double_sided) {
    IVORY_GL(glDisable, GL_CULL_FACE);
  } else {
    IVORY_GL(glEnable, GL_CULL_FACE);
  }
  IVORY_GL(glFrontFace, GLenum(handedness < 0 ? GL_CW : GL_CCW));
  IVORY_GL(glBindVertexArray, item.mesh->vertex_array.id());
  IVORY_GL(glDrawElements, GL_TRIANGLES, item.mesh->index_count, GL_UNSIGNED_INT, nullptr);
}

float depth_of(const DrawItem& item, const RuntimeCamera& camera) {
  return (item.mesh->bounds.center() * item.to_world - camera.position_m).dot(camera.forward);
}

}  // namespace

RuntimeCamera make_perspective(const M44f& to_world, float yfov_rad, float aspect, float near_m, float far_m) {
  const float f = 1 / std::tan(0.5F * yfov_rad);
  const float a = -(far_m + near_m) / (far_m - near_m);
  const float b = -2 * far_m * near_m / (far_m - near_m);
  return camera_with(to_world, {f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, a, -1, 0, 0, b, 0}, true);
}

RuntimeCamera make_orthographic(const M44f& to_world, float half_height_m, float aspect, float near_m, float far_m) {
  const float x = 1 / (half_height_m * aspect);
  const float y = 1 / half_height_m;
  const float a = -2 / (far_m - near_m);
  const float b = -(far_m + near_m) / (far_m - near_m);
  return camera_with(to_world, {x, 0, 0, 0, 0, y, 0, 0, 0, 0, a, 0, 0, 0, b, 1}, false);
}

gl::Program& Renderer::depth_program() {
  gl::Program& found = programs_["depth"];
  if (!found) {
    found = gl::make_program("depth", "#include \"renderer/surface_vertex.glsl\"\n",
                             "#include \"renderer/depth_fragment.glsl\"\n");
  }
  return found;
}

gl::Program& Renderer::program(const FrameParams& frame, const AmbientSource& ambient) {
  // The surface comes first: both parts may name it.
  const std::string source = "#include \"renderer/punctual_lights.glsl\"\n" + ambient.shader + frame.output_shader +
                             "\n#include \"renderer/surface_fragment.glsl\"\n";
  gl::Program& found = programs_[source];
  if (!found) found = gl::make_program("surface", "#include \"renderer/surface_vertex.glsl\"\n", source);
  return found;
}

void Renderer::draw_sky(const FrameParams& frame) {
  gl::Program& found = programs_["sky"];
  if (!found) found = gl::make_program("sky", sky_vertex, sky_fragment);
  if (!empty_) empty_ = gl::make<gl::Kind::vertex_array>();
  found.set("world_from_clip", frame.camera.clip_from_world.inverse());
  found.set("scale", frame.sky_scale * frame.exposure);
  found.set("from_world", turn_about_y(-double(frame.sky_turn_rad)));
  found.set("sky", 0);
  gl::bind(*frame.sky, 0);
  IVORY_GL(glDepthFunc, GL_LEQUAL);
  IVORY_GL(glDisable, GL_CULL_FACE);
  IVORY_GL(glBindVertexArray, empty_.id());
  IVORY_GL(glDrawArrays, GL_TRIANGLES, 0, 3);
}

void Renderer::prepare(const FrameParams& frame) {
  const AmbientSource none = no_ambient();
  gl::require_context();
  for (const DrawItem& item : frame.items) program(frame, item.ambient != nullptr ? *item.ambient : none);
  depth_program();
}

void Renderer::draw(const FrameParams& frame) {
  prepare(frame);  // so that a source that does not compile changes nothing
  const AmbientSource none = no_ambient();
  LightSet& lights = frame.lights != nullptr ? *frame.lights : no_lights_;
  if (!lights.updated()) lights.update({}, {});
  std::vector<const DrawItem*> opaque;
  std::vector<const DrawItem*> blended;
  for (const DrawItem& item : frame.items)
    (item.material->coverage == Coverage::blend ? blended : opaque).push_back(&item);
  // Near ones first for the depth pass; far ones first where they blend.
  std::stable_sort(opaque.begin(), opaque.end(), [&](const DrawItem* a, const DrawItem* b) {
    return depth_of(*a, frame.camera) < depth_of(*b, frame.camera);
  });
  std::stable_sort(blended.begin(), blended.end(), [&](const DrawItem* a, const DrawItem* b) {
    return depth_of(*a, frame.camera) > depth_of(*b, frame.camera);
  });

  IVORY_GL(glDisable, GL_SCISSOR_TEST);
  IVORY_GL(glCullFace, GLenum(GL_BACK));
  IVORY_GL(glBlendEquation, GLenum(GL_FUNC_ADD));
  IVORY_GL(glClearDepth, 1.0);
  IVORY_GL(glEnable, GL_DEPTH_TEST);
  IVORY_GL(glDepthMask, GLboolean(GL_TRUE));
  IVORY_GL(glColorMask, GLboolean(GL_TRUE), GLboolean(GL_TRUE), GLboolean(GL_TRUE), GLboolean(GL_TRUE));
  IVORY_GL(glDisable, GL_BLEND);
  IVORY_GL(glClearColor, frame.background.x * frame.exposure, frame.background.y * frame.exposure,
           frame.background.z * frame.exposure, 0.0F);
  IVORY_GL(glClear, GLbitfield(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT));

  IVORY_GL(glColorMask, GLboolean(GL_FALSE), GLboolean(GL_FALSE), GLboolean(GL_FALSE), GLboolean(GL_FALSE));
  IVORY_GL(glDepthFunc, GL_LESS);
  set_camera(depth_program(), frame.camera);
  for (const DrawItem* item : opaque) draw_item(depth_program(), *item, 0);
  IVORY_GL(glColorMask, GLboolean(GL_TRUE), GLboolean(GL_TRUE), GLboolean(GL_TRUE), GLboolean(GL_TRUE));

  const auto shade = [&](const DrawItem& item) {
    const AmbientSource& ambient = item.ambient != nullptr ? *item.ambient : none;
    gl::Program& p = program(frame, ambient);
    set_camera(p, frame.camera);
    p.set("ivory_direct", int(frame.direct && item.direct));
    p.set("ivory_emissive", int(frame.direct && frame.emission));
    p.set("ivory_exposure", frame.exposure);
    int unit = lights.bind(p, 0);
    unit = ambient.bind(p, unit);
    if (frame.bind_output) unit = frame.bind_output(p, unit);
    draw_item(p, item, unit);
  };
  IVORY_GL(glDepthFunc, GL_LEQUAL);
  IVORY_GL(glDepthMask, GLboolean(GL_FALSE));
  for (const DrawItem* item : opaque) shade(*item);
  if (frame.sky != nullptr) draw_sky(frame);
  IVORY_GL(glEnable, GL_BLEND);
  IVORY_GL(glBlendFuncSeparate, GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  for (const DrawItem* item : blended) shade(*item);

  IVORY_GL(glDisable, GL_BLEND);
  IVORY_GL(glDisable, GL_CULL_FACE);
  IVORY_GL(glDepthMask, GLboolean(GL_TRUE));
  IVORY_GL(glDisable, GL_DEPTH_TEST);
  IVORY_GL(glFrontFace, GL_CCW);
  IVORY_GL(glBindVertexArray, 0);
}

}  // namespace ivory
