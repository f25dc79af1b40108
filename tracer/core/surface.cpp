#include "tracer/core/surface.h"

#include <algorithm>
#include <cmath>

#include "tracer/core/surface_parts.h"
#include "tracer/core/texture.h"

namespace ivory {
namespace {

Rgb rgb(const V4f& c) { return {c.x, c.y, c.z}; }

struct Location {
  const Mesh& mesh;
  const Material& material;
  const M44f& to_world;
  int triangle;
  V2f barycentric;

  const Imath::Vec3<std::uint32_t>& indices() const { return mesh.triangles[std::size_t(triangle)]; }
  V2f uv(const TextureUse& use) const { return uv_at(mesh, triangle, barycentric, use); }
};

// The texel under a location; white where no texture is used, without a trip to the sampler.
V4f texel_at(const Scene& scene, const Location& at, const TextureUse& use, bool srgb) {
  return use.texture == no_index ? V4f(1, 1, 1, 1) : sample(scene, use, at.uv(use), srgb);
}

Location locate(const Scene& scene, int instance, int triangle, const V2f& barycentric) {
  const Instance& placed = scene.instances[std::size_t(instance)];
  const Mesh& mesh = scene.meshes[std::size_t(placed.mesh)];
  return {mesh, scene.materials[std::size_t(mesh.material)], placed.to_world, triangle, barycentric};
}

V4f base_color(const Scene& scene, const Mesh& mesh, const Material& material, int triangle, const V2f& barycentric) {
  V4f color(material.base_color.x, material.base_color.y, material.base_color.z, material.alpha);
  if (material.base_color_texture.texture != no_index) {
    color = color * sample(scene, material.base_color_texture,
                           uv_at(mesh, triangle, barycentric, material.base_color_texture), true);
  }
  if (!mesh.colors.empty()) {
    color = color * interpolate(mesh.colors, mesh.triangles[std::size_t(triangle)], barycentric);
  }
  return color;
}

// The share of light that passes straight through. As in KHR_materials_transmission it is the
// dielectric in the mix that transmits, not the metal.
float transmission(const Scene& scene, const Mesh& mesh, const Material& m, int triangle, const V2f& barycentric) {
  if (!transmits(m)) return 0;
  const auto texel = [&](const TextureUse& use) {
    return use.texture == no_index ? V4f(1, 1, 1, 1)
                                   : sample(scene, use, uv_at(mesh, triangle, barycentric, use), false);
  };
  float metallic = m.metallic;
  if (metallic > 0) metallic = std::clamp(metallic * texel(m.metallic_roughness_texture).z, 0.0F, 1.0F);
  return std::clamp(m.transmission * texel(m.transmission_texture).x, 0.0F, 1.0F) * (1 - metallic);
}

V3f transform_direction(const V3f& d, const M44f& m) {
  V3f out;
  m.multDirMatrix(d, out);
  return out;
}

V3f shading_normal(const Scene& scene, const Location& at, const V3f& front_ng) {
  if (at.mesh.normals.empty()) return front_ng;
  V3f n = normal_transform(at.to_world)(interpolate(at.mesh.normals, at.indices(), at.barycentric));
  if (!(n.length2() > 0)) return front_ng;
  n.normalize();

  const TextureUse& use = at.material.normal_texture;
  if (use.texture == no_index || at.mesh.tangents.empty()) return n;
  const V4f tangent4 = interpolate(at.mesh.tangents, at.indices(), at.barycentric);
  V3f tangent = transform_direction({tangent4.x, tangent4.y, tangent4.z}, at.to_world);
  tangent -= n * n.dot(tangent);
  if (!(tangent.length2() > 0)) return n;
  tangent.normalize();
  // A mirroring transform turns the handedness of the tangent frame with it.
  const float handedness = (tangent4.w < 0 ? -1.0F : 1.0F) * (at.to_world.determinant() < 0 ? -1.0F : 1.0F);
  const V3f bitangent = n.cross(tangent) * handedness;
  const V4f texel = sample(scene, use, at.uv(use), false);
  const V3f local((texel.x * 2 - 1) * at.material.normal_scale, (texel.y * 2 - 1) * at.material.normal_scale,
                  texel.z * 2 - 1);
  const V3f mapped = tangent * local.x + bitangent * local.y + n * local.z;
  return mapped.length2() > 0 ? mapped.normalized() : n;
}

// glTF 2.0 appendix B.2 with KHR_materials_ior and KHR_materials_specular:
// dielectric F0 = min(((ior-1)/(ior+1))^2 specularColor, 1) specular, F90 = specular;
// metal F0 = base colour, F90 = 1, no diffuse; mixed by metallic.
void set_metallic_roughness(const Scene& scene, const Location& at, const Rgb& base, Surface& surface) {
  const Material& m = at.material;
  const V4f texel = texel_at(scene, at, m.metallic_roughness_texture, false);
  const float metallic = std::clamp(m.metallic * texel.z, 0.0F, 1.0F);
  const float roughness = std::clamp(m.roughness * texel.y, 0.0F, 1.0F);
  const float specular = m.specular * texel_at(scene, at, m.specular_texture, false).w;
  const Rgb specular_color = m.specular_color * rgb(texel_at(scene, at, m.specular_color_texture, true));
  const float reflectance = (m.ior - 1) / (m.ior + 1);
  Rgb dielectric_f0 = specular_color * (reflectance * reflectance);
  for (unsigned c = 0; c < 3; ++c) dielectric_f0[c] = std::min(dielectric_f0[c], 1.0F) * specular;

  surface.diffuse_albedo = base * (1 - metallic);
  surface.specular_f0 = dielectric_f0 * (1 - metallic) + base * metallic;
  const float f90 = specular * (1 - metallic) + metallic;
  surface.specular_f90 = Rgb(f90, f90, f90);
  surface.roughness_alpha = roughness * roughness;
}

// KHR_materials_pbrSpecularGlossiness: diffuse scaled by what the specular colour leaves over.
void set_specular_glossiness(const Scene& scene, const Location& at, const Rgb& base, Surface& surface) {
  const Material& m = at.material;
  const V4f texel = texel_at(scene, at, m.specular_color_texture, true);
  const Rgb f0 = m.specular_color * rgb(texel);
  const float roughness = 1 - std::clamp(m.glossiness * texel.w, 0.0F, 1.0F);
  surface.diffuse_albedo = base * (1 - std::clamp(max_component(f0), 0.0F, 1.0F));
  surface.specular_f0 = f0;
  surface.specular_f90 = is_black(f0) ? Rgb(0, 0, 0) : Rgb(1, 1, 1);
  surface.roughness_alpha = roughness * roughness;
}

Rgb emission(const Scene& scene, const Location& at) {
  const Material& m = at.material;
  if (is_black(m.emission) || m.emission_texture.texture == no_index) return m.emission;
  return m.emission * rgb(texel_at(scene, at, m.emission_texture, true));
}

float reach_of(const Location& at) {
  float reach = 0;
  for (const std::uint32_t vertex : {at.indices().x, at.indices().y, at.indices().z}) {
    reach = std::max(reach, largest_coordinate(transform_point(at.mesh.positions[vertex], at.to_world)));
  }
  return reach;
}

// Points on a triangle lie this close to it, as a share of its reach: twice what offset_origin() takes.
constexpr float own_surface = 0x1p-18F;

}  // namespace

float triangle_reach_m(const Scene& scene, int instance, int triangle) {
  return reach_of(locate(scene, instance, triangle, V2f(0, 0)));
}

bool is_own_surface(const Scene& scene, const Hit& hit, float distance_m, const V3f& direction) {
  constexpr float parallel = 0.99F;
  return std::abs(hit.ng.dot(direction)) > parallel &&
         distance_m <= own_surface * triangle_reach_m(scene, hit.instance, hit.triangle);
}

float own_surface_reach_m(const Intersector& intersector, const V3f& p, const V3f& ng) {
  const V3f& center = intersector.center();
  const float farthest =
      std::max({std::abs(center.x), std::abs(center.y), std::abs(center.z)}) + intersector.radius_m();
  const float within = own_surface * farthest;
  constexpr float any_coverage = 1e-6F;
  Ray ray{.origin = p - ng * within, .direction = ng, .t_max = 2 * within, .blocking_coverage = any_coverage};
  // Other surfaces may lie as close in a large scene; four deep is enough for a decal on a sheet.
  for (int i = 0; i < 4; ++i) {
    const std::optional<Hit> hit = intersector.closest(ray);
    if (!hit) return 0;
    if (is_own_surface(intersector.scene(), *hit, std::abs(hit->t - within), ng))
      return triangle_reach_m(intersector.scene(), hit->instance, hit->triangle);
    ray.t_min = hit->t * (1 + 0x1p-20F);
  }
  return 0;
}

Surface make_surface(const Scene& scene, const Ray& ray, const Hit& hit) {
  const Location at = locate(scene, hit.instance, hit.triangle, hit.barycentric);
  Surface surface;
  // The point comes from the triangle, not from the ray: its error does not grow with the distance.
  surface.p = transform_point(interpolate(at.mesh.positions, at.indices(), hit.barycentric), at.to_world);
  surface.reach_m = reach_of(at);
  surface.front = ray.direction.dot(hit.ng) <= 0;
  surface.ng = surface.front ? hit.ng : -hit.ng;
  surface.ns = facing_normal(surface, shading_normal(scene, at, hit.ng), ray.direction);

  const Rgb base = rgb(base_color(scene, at.mesh, at.material, hit.triangle, hit.barycentric));
  if (at.material.specular_glossiness) {
    set_specular_glossiness(scene, at, base, surface);
  } else {
    set_metallic_roughness(scene, at, base, surface);
  }
  for (unsigned c = 0; c < 3; ++c) surface.diffuse_albedo[c] = std::clamp(surface.diffuse_albedo[c], 0.0F, 1.0F);
  for (unsigned c = 0; c < 3; ++c) surface.specular_f0[c] = std::clamp(surface.specular_f0[c], 0.0F, 1.0F);
  surface.emission = surface.front || at.material.double_sided ? emission(scene, at) : Rgb(0, 0, 0);
  return surface;
}

V3f offset_origin(const V3f& p, const V3f& ng, const V3f& w, float reach_m) {
  // Embree's robust intersections are good to a few units in the last place of the largest
  // coordinate; 2^-17 of it is 64 of those. Near the world's origin p is small, but its error is that of the
  // triangle's corners: of 32 units in their last place, a few in a hundred thousand rays met a slope again at 8.
  // Where the triangle is not known, a floor stands in for it.
  const float largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  const float step = std::max(largest * 0x1p-17F, reach_m > 0 ? reach_m * 0x1p-19F : 1e-7F);
  return p + ng * (ng.dot(w) >= 0 ? step : -step);
}

Ray spawn_ray(const Surface& surface, const V3f& w, std::uint32_t coverage_seed) {
  return {.origin = offset_origin(surface.p, surface.ng, w, surface.reach_m),
          .direction = w,
          .coverage_seed = coverage_seed};
}

Rgb emission_at(const Scene& scene, int mesh_index, int triangle, const V2f& barycentric) {
  const Mesh& mesh = scene.meshes[std::size_t(mesh_index)];
  const M44f nowhere;  // what is emitted does not depend on the place
  return emission(scene, {mesh, scene.materials[std::size_t(mesh.material)], nowhere, triangle, barycentric});
}

float coverage_at(const Scene& scene, int mesh_index, int triangle, const V2f& barycentric) {
  const Mesh& mesh = scene.meshes[std::size_t(mesh_index)];
  const Material& material = scene.materials[std::size_t(mesh.material)];
  const float opaque = 1 - transmission(scene, mesh, material, triangle, barycentric);
  if (material.alpha_mode == AlphaMode::opaque) return opaque;
  const float alpha = base_color(scene, mesh, material, triangle, barycentric).w;
  if (material.alpha_mode == AlphaMode::mask) return alpha >= material.alpha_cutoff ? opaque : 0.0F;
  return std::clamp(alpha, 0.0F, 1.0F) * opaque;
}

}  // namespace ivory
