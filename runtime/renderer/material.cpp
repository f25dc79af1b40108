#include "runtime/renderer/material.h"

#include <fmt/format.h>

#include "runtime/gl/check.h"

namespace ivory {

int bind(const SurfaceMaterial& m, gl::Program& program, int first_unit) {
  program.set("ivory_base_color", V4f(m.base_color.x, m.base_color.y, m.base_color.z, m.alpha));
  program.set("ivory_surface", V4f(m.metallic, m.roughness, m.dielectric_f90, m.specular_glossiness ? 1.0F : 0.0F));
  program.set("ivory_dielectric_f0", m.dielectric_f0);
  const float cutoff = m.coverage == Coverage::opaque ? -1.0F : m.coverage == Coverage::blend ? -2.0F : m.alpha_cutoff;
  program.set("ivory_emission", V4f(m.emission.x, m.emission.y, m.emission.z, cutoff));
  program.set("ivory_double_sided", int(m.double_sided));

  const std::array<const MaterialTexture*, 4> uses{&m.base_color_texture, &m.surface_texture, &m.normal_texture,
                                                   &m.emission_texture};
  std::array<int, 4> has{};
  std::array<V4f, 8> rows{};
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const MaterialTexture& use = *uses[i];
    // One that is absent keeps its unit, and keeps it empty: samplers of different kinds must not share a unit, and
    // none may hold what is being drawn into, read or not.
    program.set(fmt::format("ivory_textures[{}]", i), first_unit + int(i));
    if (use.texture == nullptr) {
      IVORY_GL(glActiveTexture, GLenum(GL_TEXTURE0 + first_unit + int(i)));
      IVORY_GL(glBindTexture, GL_TEXTURE_2D, 0);
      continue;
    }
    has[i] = 1;
    const std::array<float, 6>& t = use.uv_transform;
    rows[2 * i] = V4f(t[0], t[1], t[2], float(use.uv_set));
    rows[2 * i + 1] = V4f(t[3], t[4], t[5], 0);
    gl::bind(*use.texture, first_unit + int(i));
  }
  program.set("ivory_uv_rows", rows.data(), int(rows.size()));
  program.set_ivec4("ivory_has_texture", has);
  return first_unit + int(uses.size());
}

}  // namespace ivory
