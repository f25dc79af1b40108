#include "tracer/lights/triangle.h"

#include <algorithm>
#include <cmath>

#include "tracer/core/sampling.h"
#include "tracer/core/surface.h"
#include "tracer/lights/emission/integral.h"

namespace ivory {

TriangleLight make_triangle_light(const Scene& scene, const MeshEmission& emission, int index, int triangle) {
  const Instance& instance = scene.instances[std::size_t(index)];
  const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
  const auto& indices = mesh.triangles[std::size_t(triangle)];
  // glTF: a negative determinant flips the winding, so that the front stays the front.
  const float side = instance.to_world.determinant() < 0 ? -1.0F : 1.0F;
  TriangleLight light;
  light.mean_radiance = emission.mean_radiance[std::size_t(triangle)];
  light.vertex = mesh.positions[indices.x] * instance.to_world;
  light.edge1 = mesh.positions[indices.y] * instance.to_world - light.vertex;
  light.edge2 = mesh.positions[indices.z] * instance.to_world - light.vertex;
  const V3d normal = V3d(light.edge1).cross(V3d(light.edge2));
  const double length = normal.length();
  light.area_m2 = float(0.5 * length);
  light.ng = V3f(normal * (double(side) / length));
  light.reach_m = triangle_reach_m(scene, index, triangle);
  light.double_sided = scene.materials[std::size_t(mesh.material)].double_sided;
  light.instance = index;
  light.triangle = triangle;
  light.emission = &emission;
  return light;
}

Rgb power_lm(const TriangleLight& light) {
  return light.mean_radiance * (pi * light.area_m2 * (light.double_sided ? 2.0F : 1.0F));
}

namespace {

// A point of density d times a uniform one's (pdf d/A) and a cosine-distributed direction (pdf cos/pi) on a uniformly
// chosen side (1/sides) carry L cos / pdf = L pi A sides / d.
EmittedPhoton photon_from(const Scene& scene, const TriangleLight& light, const EmissionPoint& point, bool back,
                          const V3f& local) {
  const V2f& b = point.barycentric;
  const V3f n = back ? -light.ng : light.ng;
  const V3f direction = make_shading_frame(n).to_world(local).normalized();
  const V3f p = light.vertex + light.edge1 * b.x + light.edge2 * b.y;
  const Rgb radiance = point.density > 0
                           ? covered_emission_at(scene, light.emission->mesh, light.triangle, b) / point.density
                           : Rgb(0, 0, 0);
  return {offset_origin(p, light.ng, direction, light.reach_m), direction,
          radiance * (pi * light.area_m2 * (light.double_sided ? 2.0F : 1.0F))};
}

}  // namespace

EmittedPhoton emit(const Scene& scene, const TriangleLight& light, RandomStream& random) {
  const EmissionPoint point = sample_point(scene, *light.emission, light.triangle, random);
  const bool back = random.next() < 0.5F && light.double_sided;
  return photon_from(scene, light, point, back, sample_cosine_hemisphere(random.next2()));
}

EmittedPhoton emit(const Scene& scene, const TriangleLight& light, const Imath::V2d& u_point,
                   const Imath::V2d& u_direction, RandomStream& random) {
  const EmissionPoint point = sample_point(scene, *light.emission, light.triangle, u_point, random);
  Imath::V2d u = u_direction;
  const bool back = light.double_sided && u.x < 0.5;
  if (light.double_sided) u.x = 2 * u.x - (back ? 0 : 1);
  const Imath::V2d d = sample_disc_compact(u);
  // Never along the surface: where u is at the rim, d's length may round to one.
  const V3f local(float(d.x), float(d.y), float(std::sqrt(std::max(0x1p-24, 1 - d.dot(d)))));
  return photon_from(scene, light, point, back, local);
}

namespace {

// pdf_solid_angle = r^2 / (A cos) for a uniform point, of which others are a multiple; 0 where the side towards p is
// dark.
float area_to_solid_angle(const TriangleLight& light, const V3f& w, float r2) {
  const float cosine = -light.ng.dot(w);
  const float facing = light.double_sided ? std::abs(cosine) : cosine;
  return facing > 0 ? r2 / (light.area_m2 * facing) : 0.0F;
}

std::optional<LightSample> sample_at(const Scene& scene, const TriangleLight& light, const V3f& p,
                                     const EmissionPoint& chosen) {
  const V2f& b = chosen.barycentric;
  const V3f point = light.vertex + light.edge1 * b.x + light.edge2 * b.y;
  const V3f d = point - p;
  const float r2 = d.dot(d);
  if (!(r2 > 0)) return std::nullopt;
  const float r = std::sqrt(r2);
  const V3f w = d / r;
  const float pdf = area_to_solid_angle(light, w, r2) * chosen.density;
  if (!(pdf > 0) || !std::isfinite(pdf)) return std::nullopt;
  const Rgb radiance = covered_emission_at(scene, light.emission->mesh, light.triangle, b);
  if (is_black(radiance)) return std::nullopt;
  return LightSample{w, r, radiance / pdf, pdf, false, point, light.ng, light.reach_m};
}

}  // namespace

std::optional<LightSample> sample(const Scene& scene, const TriangleLight& light, const V3f& p, RandomStream& random) {
  return sample_at(scene, light, p, sample_point(scene, *light.emission, light.triangle, random));
}

std::optional<LightSample> sample(const Scene& scene, const TriangleLight& light, const V3f& p, const Imath::V2d& u,
                                  RandomStream& random) {
  return sample_at(scene, light, p, sample_point(scene, *light.emission, light.triangle, u, random));
}

float pdf_solid_angle(const Scene& scene, const TriangleLight& light, const V3f& p, const V2f& b) {
  const V3f d = light.vertex + light.edge1 * b.x + light.edge2 * b.y - p;
  const float r2 = d.dot(d);
  if (!(r2 > 0)) return 0;
  const float pdf =
      area_to_solid_angle(light, d / std::sqrt(r2), r2) * point_density(scene, *light.emission, light.triangle, b);
  return std::isfinite(pdf) ? pdf : 0.0F;
}

}  // namespace ivory
