#include "runtime/renderer/punctual_light.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <ImathBoxAlgo.h>
#include <fmt/format.h>

#include "grid/base/error.h"
#include "runtime/gl/check.h"

namespace ivory {

namespace {

// std140 of the block IvoryLights in shaders/renderer/punctual_lights.glsl.
struct LightBlock {
  struct Light {
    V4f position_kind;    // world, and LightKind
    V4f direction_outer;  // the way the light travels or a normal; spots: 1 - cosine of the outer angle, else extent
    V4f intensity_width;  // cd or lux, inner minus outer cosine
    V4f shadow;           // first layer or -1, world size of a shadow texel (at 1 m unless directional)
  };
  std::int32_t count = 0;
  std::array<std::int32_t, 3> padding{};
  std::array<Light, max_lights> lights{};
  std::array<M44f, max_shadow_layers> clip_from_world;
};
static_assert(sizeof(LightBlock) == 16 + 64 * max_lights + 64 * max_shadow_layers);

constexpr GLuint block_binding = 0;

M44f look(const V3f& eye, const V3f& forward, const V3f& up_hint) {
  const V3f z = -forward;
  const V3f x = up_hint.cross(z).normalized();
  const V3f y = z.cross(x);
  return {x.x, y.x, z.x, 0, x.y, y.y, z.y, 0, x.z, y.z, z.z, 0, -x.dot(eye), -y.dot(eye), -z.dot(eye), 1};
}

M44f perspective(float half_angle_rad, float near_m, float far_m) {
  const float f = 1 / std::tan(half_angle_rad);
  const float a = -(far_m + near_m) / (far_m - near_m);
  const float b = -2 * far_m * near_m / (far_m - near_m);
  return {f, 0, 0, 0, 0, f, 0, 0, 0, 0, a, -1, 0, 0, b, 0};
}

// Without the difference, which float loses for narrow cones.
double one_minus_cosine(float angle_rad) {
  const double s = std::sin(0.5 * double(angle_rad));
  return 2 * s * s;
}

V3f any_up(const V3f& forward) { return std::abs(forward.y) < 0.9F ? V3f(0, 1, 0) : V3f(1, 0, 0); }

Box3f bounds_of(std::span<const ShadowCaster> casters) {
  Box3f box;
  for (const ShadowCaster& caster : casters) box.extendBy(Imath::transform(caster.mesh->bounds, caster.to_world));
  return box;
}

float farthest(const Box3f& box, const V3f& p) {
  const V3f d(std::max(std::abs(box.min.x - p.x), std::abs(box.max.x - p.x)),
              std::max(std::abs(box.min.y - p.y), std::abs(box.max.y - p.y)),
              std::max(std::abs(box.min.z - p.z), std::abs(box.max.z - p.z)));
  return d.length();
}

// A box around the sphere around all casters, so that its size does not change with the light's direction.
M44f directional_clip(const RuntimeLight& light, const Box3f& box, float radius) {
  const M44f view = look(box.center(), light.direction, any_up(light.direction));
  M44f scale;
  scale.setScale(V3f(1 / radius, 1 / radius, -1 / radius));
  return view * scale;
}

// The six faces of a cube; in the shader +x -x +y -y +z -z by the largest coordinate.
constexpr std::array<std::array<float, 3>, 6> face_forward{
    {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

constexpr const char* depth_vertex = R"(
layout(location = 0) in vec3 position;
uniform mat4 clip_from_object;
void main() { gl_Position = clip_from_object * vec4(position, 1.0); }
)";

// Put back at the end of the scope, whatever ends it.
class FramebufferAndViewport {
 public:
  FramebufferAndViewport() {
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_);
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_);
    glGetIntegerv(GL_VIEWPORT, viewport_.data());
    gl::check("glGetIntegerv");
  }
  FramebufferAndViewport(const FramebufferAndViewport&) = delete;
  FramebufferAndViewport& operator=(const FramebufferAndViewport&) = delete;
  ~FramebufferAndViewport() {
    glDisable(GL_POLYGON_OFFSET_FILL);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(draw_));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(read_));
    glViewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
  }

 private:
  GLint draw_ = 0;
  GLint read_ = 0;
  std::array<GLint, 4> viewport_{};
};

int layers_of(const RuntimeLight& light) {
  if (!light.casts_shadow) return 0;
  return light.kind == LightKind::point || light.kind == LightKind::patch ? 6 : 1;
}

}  // namespace

void LightSet::make_objects(int size, int layers) {
  if (!uniforms_) uniforms_ = gl::make<gl::Kind::buffer>();
  if (!framebuffer_) {
    framebuffer_ = gl::make<gl::Kind::framebuffer>();
    IVORY_GL(glBindFramebuffer, GL_FRAMEBUFFER, framebuffer_.id());
    // Depth alone: without these OpenGL 3.3 takes the framebuffer for incomplete.
    IVORY_GL(glDrawBuffer, GLenum(GL_NONE));
    IVORY_GL(glReadBuffer, GLenum(GL_NONE));
  }
  if (!depth_program_) depth_program_ = gl::make_program("shadow maps", depth_vertex, "void main() {}");
  if (depth_.object && depth_.size == V3i(size, size, layers)) return;
  depth_ = gl::make_texture_array("shadow maps", gl::Format::depth24, size, size, layers, gl::Filter::linear);
  IVORY_GL(glTexParameteri, GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_MODE, GLint(GL_COMPARE_REF_TO_TEXTURE));
  IVORY_GL(glTexParameteri, GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_FUNC, GLint(GL_LEQUAL));
}

void LightSet::draw_depth(const ShadowCaster& caster, const M44f& clip_from_world) {
  if (caster.material != nullptr && caster.material->coverage != Coverage::opaque) {
    if (!masked_program_) {
      masked_program_ = gl::make_program("masked shadow maps", "#include \"renderer/surface_vertex.glsl\"\n",
                                         "#include \"renderer/depth_fragment.glsl\"\n");
    }
    masked_program_.set("ivory_clip_from_world", clip_from_world);
    masked_program_.set("ivory_world_from_object", caster.to_world);
    ivory::bind(*caster.material, masked_program_, 0);
  } else {
    depth_program_.set("clip_from_object", caster.to_world * clip_from_world);
  }
  IVORY_GL(glBindVertexArray, caster.mesh->vertex_array.id());
  IVORY_GL(glDrawElements, GL_TRIANGLES, caster.mesh->index_count, GL_UNSIGNED_INT, nullptr);
}

void LightSet::update(std::span<const RuntimeLight> lights, std::span<const ShadowCaster> casters,
                      const ShadowParams& params) {
  gl::require_context();
  if (lights.size() > max_lights) {
    throw Error("lights", fmt::format("{} are more than the {} that one frame can have", lights.size(), max_lights),
                "leave out the weakest");
  }
  const Box3f box = bounds_of(casters);
  const float radius = std::max(0.5F * box.size().length(), 1e-6F);

  LightBlock block;
  block.count = std::int32_t(lights.size());
  std::size_t layers = 0;
  unshadowed_ = 0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const RuntimeLight& light = lights[i];
    LightBlock::Light& out = block.lights[i];
    const double outer = one_minus_cosine(light.outer_angle_rad);
    // As narrow as tracer/lights/punctual.cpp has it.
    const double width = std::max({outer - one_minus_cosine(light.inner_angle_rad), 1e-6 * outer, 1e-30});
    out.position_kind = V4f(light.position_m.x, light.position_m.y, light.position_m.z, float(light.kind));
    out.direction_outer = V4f(light.direction.x, light.direction.y, light.direction.z,
                              light.kind == LightKind::spot ? float(outer) : light.extent);
    out.intensity_width = V4f(light.intensity.x, light.intensity.y, light.intensity.z, float(width));
    out.shadow = V4f(-1, 0, 0, 0);
    const auto wanted = std::size_t(layers_of(light));
    if (wanted == 0 || box.isEmpty()) continue;
    if (layers + wanted > max_shadow_layers) {
      ++unshadowed_;
      continue;
    }
    const float far_m = std::max(farthest(box, light.position_m), 1e-6F);
    const float near_m = far_m * 1e-3F;
    // A spot's map is a little wider than its cone, for the filter at the rim.
    const float half_angle = wanted == 6 ? pi / 4 : std::min(light.outer_angle_rad * 1.02F, 1.55F);
    switch (light.kind) {
      case LightKind::directional:
        block.clip_from_world[layers] = directional_clip(light, box, radius);
        break;
      case LightKind::spot:
        block.clip_from_world[layers] =
            look(light.position_m, light.direction, any_up(light.direction)) * perspective(half_angle, near_m, far_m);
        break;
      case LightKind::point:
      case LightKind::patch:
        for (std::size_t face = 0; face < 6; ++face) {
          const V3f forward(face_forward[face][0], face_forward[face][1], face_forward[face][2]);
          block.clip_from_world[layers + face] =
              look(light.position_m, forward, any_up(forward)) * perspective(half_angle, near_m, far_m);
        }
        break;
    }
    const float texel =
        (light.kind == LightKind::directional ? 2 * radius : 2 * std::tan(half_angle)) / float(params.size);
    out.shadow = V4f(float(layers), texel, 0, 0);
    layers += wanted;
  }

  const FramebufferAndViewport as_found;
  // Without shadows one texel stands in.
  make_objects(layers > 0 ? params.size : 1, std::max(1, int(layers)));
  IVORY_GL(glBindBuffer, GL_UNIFORM_BUFFER, uniforms_.id());
  IVORY_GL(glBufferData, GL_UNIFORM_BUFFER, GLsizeiptr(sizeof(block)), &block, GL_DYNAMIC_DRAW);

  IVORY_GL(glBindFramebuffer, GL_DRAW_FRAMEBUFFER, framebuffer_.id());
  IVORY_GL(glViewport, 0, 0, params.size, params.size);
  IVORY_GL(glDisable, GL_SCISSOR_TEST);
  IVORY_GL(glClearDepth, 1.0);
  IVORY_GL(glEnable, GL_DEPTH_TEST);
  IVORY_GL(glDepthFunc, GL_LESS);
  IVORY_GL(glDepthMask, GLboolean(GL_TRUE));
  IVORY_GL(glDisable, GL_CULL_FACE);
  IVORY_GL(glEnable, GL_POLYGON_OFFSET_FILL);
  IVORY_GL(glPolygonOffset, 1.5F, 2.0F);
  for (std::size_t layer = 0; layer < layers; ++layer) {
    IVORY_GL(glFramebufferTextureLayer, GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, depth_.object.id(), 0, GLint(layer));
    IVORY_GL(glClear, GL_DEPTH_BUFFER_BIT);
    for (const ShadowCaster& caster : casters) draw_depth(caster, block.clip_from_world[layer]);
  }
  IVORY_GL(glBindVertexArray, 0);
}

int LightSet::bind(gl::Program& program, int first_unit) {
  assert(uniforms_);
  const GLuint index = glGetUniformBlockIndex(program.id(), "IvoryLights");
  gl::check("glGetUniformBlockIndex");
  if (index != GL_INVALID_INDEX) IVORY_GL(glUniformBlockBinding, program.id(), index, block_binding);
  IVORY_GL(glBindBufferBase, GL_UNIFORM_BUFFER, block_binding, uniforms_.id());
  program.set("ivory_shadow_maps", first_unit);
  gl::bind(depth_, first_unit);
  return first_unit + 1;
}

std::size_t LightSet::bytes() const { return depth_.bytes() + (uniforms_ ? sizeof(LightBlock) : 0); }

}  // namespace ivory
