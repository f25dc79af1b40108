#include "tracer/bsdf/lobe_reflectance.h"

#include <algorithm>
#include <cmath>

#include "tracer/core/sampling.h"

namespace ivory {

namespace {

// The frame that anisotropic lobes lie in: along the mesh's tangents where it has them.
ShadingFrame tangent_frame(const Scene& scene, const Hit& hit, const V3f& ns) {
  const Instance& instance = scene.instances[std::size_t(hit.instance)];
  const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
  if (mesh.tangents.empty()) return make_shading_frame(ns);
  const auto& t = mesh.triangles[std::size_t(hit.triangle)];
  const V2f& b = hit.barycentric;
  const V4f tangent4 = mesh.tangents[t.x] * (1 - b.x - b.y) + mesh.tangents[t.y] * b.x + mesh.tangents[t.z] * b.y;
  V3f tangent;
  instance.to_world.multDirMatrix(V3f(tangent4.x, tangent4.y, tangent4.z), tangent);
  tangent -= ns * ns.dot(tangent);
  if (!(tangent.length2() > 0)) return make_shading_frame(ns);
  tangent.normalize();
  // The model is even in the bitangent's sign.
  return {tangent, ns.cross(tangent), ns};
}

}  // namespace

LobeReflectance make_lobe_reflectance(const Scene& scene, const Hit& hit, const Surface& surface, const V3f& wo) {
  LobeReflectance r;
  r.ns = surface.ns;
  const int mesh = scene.instances[std::size_t(hit.instance)].mesh;
  const Material& material = scene.materials[std::size_t(scene.meshes[std::size_t(mesh)].material)];
  if (!material.lafortune.empty()) {
    r.diffuse = surface.diffuse_albedo / pi;
    const ShadingFrame frame = tangent_frame(scene, hit, surface.ns);
    const V3f v = frame.to_local(wo);
    for (const LafortuneLobe& lobe : material.lafortune) {
      // k (wi . C v)^e = k |C v|^e (wi . C v/|C v|)^e  (the report's eq. 30).
      const V3f axis = lobe.c * v;
      const float length = axis.length();
      const Rgb k = lobe.tinted ? lobe.k * surface.diffuse_albedo : lobe.k;
      if (!(length > 0) || is_black(k)) continue;
      r.glossy[std::size_t(r.glossy_count++)] = {frame.to_world(axis / length).normalized(), lobe.exponent,
                                                 k * std::pow(length, lobe.exponent)};
    }
    return r;
  }
  const Rgb& ks = surface.specular_f0;
  r.diffuse = surface.diffuse_albedo * (std::max(0.0F, 1 - max_component(ks)) / pi);
  if (is_black(ks)) return r;
  const float exponent = phong_exponent(surface.roughness_alpha);
  const V3f mirror = surface.ns * (2 * surface.ns.dot(wo)) - wo;
  r.glossy[0] = {mirror.normalized(), exponent, ks * ((exponent + 2) / (2 * pi))};
  r.glossy_count = 1;
  return r;
}

}  // namespace ivory
