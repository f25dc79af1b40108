#include "tracer/lights/triangle.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "tracer/core/sampling.h"
#include "tracer/core/surface.h"
#include "tracer/core/texture.h"

namespace ivory {

namespace {

// What leaves the triangle at b: coverage counts, because a hit ray meets a BLEND or MASK surface
// with just that probability.
Rgb radiance_at(const Scene& scene, int instance, int triangle, const V2f& b) {
  const int mesh = scene.instances[std::size_t(instance)].mesh;
  const Material& material = scene.materials[std::size_t(scene.meshes[std::size_t(mesh)].material)];
  const Rgb emission = emission_at(scene, instance, triangle, b);
  if (material.alpha_mode == AlphaMode::opaque) return emission;
  return emission * coverage_at(scene, mesh, triangle, b);
}

// Longest edge of the triangle in texels of a texture.
float extent_texels(const Scene& scene, const Mesh& mesh, int triangle, const TextureUse& use) {
  if (use.texture == no_index) return 0;
  const int image = scene.textures[std::size_t(use.texture)].image;
  if (image == no_index) return 0;
  const V2f size(float(scene.images[std::size_t(image)].width), float(scene.images[std::size_t(image)].height));
  const std::array<V2f, 3> corners{uv_at(mesh, triangle, {0, 0}, use) * size, uv_at(mesh, triangle, {1, 0}, use) * size,
                                   uv_at(mesh, triangle, {0, 1}, use) * size};
  float longest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const V2f edge = corners[(i + 1) % 3] - corners[i];
    longest = std::max({longest, std::abs(edge.x), std::abs(edge.y)});
  }
  return longest;
}

// Mean radiance by the centroid rule over n^2 equal triangles, n such that their edges are no longer
// than a texel where the budget allows. Only the choice among lights rests on it, never a mean: the
// estimators evaluate the texture itself.
Rgb mean_radiance(const Scene& scene, int instance, int triangle, int most_steps) {
  const Mesh& mesh = scene.meshes[std::size_t(scene.instances[std::size_t(instance)].mesh)];
  const Material& material = scene.materials[std::size_t(mesh.material)];
  float extent = extent_texels(scene, mesh, triangle, material.emission_texture);
  if (material.alpha_mode != AlphaMode::opaque) {
    extent = std::max(extent, extent_texels(scene, mesh, triangle, material.base_color_texture));
    if (!mesh.colors.empty()) extent = std::max(extent, 8.0F);
  }
  const int n = int(std::clamp(std::ceil(extent), 1.0F, float(most_steps)));
  double sum[3] = {0, 0, 0};
  const auto add = [&](float i, float j) {
    const Rgb radiance = radiance_at(scene, instance, triangle, V2f(i, j) / float(n));
    for (int c = 0; c < 3; ++c) sum[c] += double(radiance[c]);
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n - i; ++j) {
      add(float(i) + 1.0F / 3, float(j) + 1.0F / 3);
      if (j < n - i - 1) add(float(i) + 2.0F / 3, float(j) + 2.0F / 3);
    }
  }
  const double count = double(n) * n;
  return Rgb(float(sum[0] / count), float(sum[1] / count), float(sum[2] / count));
}

std::vector<Rgb> mean_radiances(const Scene& scene, int instance) {
  // The quadrature's budget for a mesh, about a second in all.
  constexpr double evaluations = 1.6e7;
  const auto& mesh = scene.meshes[std::size_t(scene.instances[std::size_t(instance)].mesh)];
  const int most_steps =
      int(std::clamp(std::sqrt(evaluations / double(std::max<std::size_t>(1, mesh.triangles.size()))), 4.0, 512.0));
  std::vector<Rgb> means(mesh.triangles.size());
  for (std::size_t t = 0; t < means.size(); ++t) means[t] = mean_radiance(scene, instance, int(t), most_steps);
  return means;
}

}  // namespace

std::vector<TriangleLight> make_triangle_lights(const Scene& scene) {
  std::vector<TriangleLight> lights;
  std::unordered_map<int, std::vector<Rgb>> means_by_mesh;  // shared by the instances of a mesh
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    const Material& material = scene.materials[std::size_t(mesh.material)];
    if (is_black(material.emission)) continue;
    auto found = means_by_mesh.find(instance.mesh);
    if (found == means_by_mesh.end()) found = means_by_mesh.emplace(instance.mesh, mean_radiances(scene, int(i))).first;

    // glTF: a negative determinant flips the winding, so that the front stays the front.
    const float side = instance.to_world.determinant() < 0 ? -1.0F : 1.0F;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& indices = mesh.triangles[t];
      TriangleLight light;
      light.mean_radiance = found->second[t];
      light.vertex = mesh.positions[indices.x] * instance.to_world;
      light.edge1 = mesh.positions[indices.y] * instance.to_world - light.vertex;
      light.edge2 = mesh.positions[indices.z] * instance.to_world - light.vertex;
      const V3d normal = V3d(light.edge1).cross(V3d(light.edge2));
      const double length = normal.length();
      light.area_m2 = float(0.5 * length);
      if (!(light.area_m2 > 0) || is_black(light.mean_radiance)) continue;
      light.ng = V3f(normal * (double(side) / length));
      light.reach_m = triangle_reach_m(scene, int(i), int(t));
      light.double_sided = material.double_sided;
      light.instance = int(i);
      light.triangle = int(t);
      lights.push_back(light);
    }
  }
  return lights;
}

Rgb power_lm(const TriangleLight& light) {
  return light.mean_radiance * (pi * light.area_m2 * (light.double_sided ? 2.0F : 1.0F));
}

// A uniform point (pdf 1/A) and a cosine-distributed direction (pdf cos/pi) on a uniformly chosen
// side (1/sides) carry L cos / pdf = L pi A sides.
EmittedPhoton emit(const Scene& scene, const TriangleLight& light, RandomStream& random) {
  const V2f b = sample_triangle(random.next2());
  const float u_side = random.next();
  const V3f n = light.double_sided && u_side < 0.5F ? -light.ng : light.ng;
  const V3f direction = make_shading_frame(n).to_world(sample_cosine_hemisphere(random.next2())).normalized();
  const V3f p = light.vertex + light.edge1 * b.x + light.edge2 * b.y;
  const Rgb radiance = radiance_at(scene, light.instance, light.triangle, b);
  return {offset_origin(p, light.ng, direction, light.reach_m), direction,
          radiance * (pi * light.area_m2 * (light.double_sided ? 2.0F : 1.0F))};
}

namespace {

// pdf_solid_angle = r^2 / (A cos) for a uniform point; 0 where the side towards p is dark.
float area_to_solid_angle(const TriangleLight& light, const V3f& w, float r2) {
  const float cosine = -light.ng.dot(w);
  const float facing = light.double_sided ? std::abs(cosine) : cosine;
  return facing > 0 ? r2 / (light.area_m2 * facing) : 0.0F;
}

}  // namespace

std::optional<LightSample> sample(const Scene& scene, const TriangleLight& light, const V3f& p, RandomStream& random) {
  const V2f b = sample_triangle(random.next2());
  const V3f point = light.vertex + light.edge1 * b.x + light.edge2 * b.y;
  const V3f d = point - p;
  const float r2 = d.dot(d);
  if (!(r2 > 0)) return std::nullopt;
  const float r = std::sqrt(r2);
  const V3f w = d / r;
  const float pdf = area_to_solid_angle(light, w, r2);
  if (!(pdf > 0) || !std::isfinite(pdf)) return std::nullopt;
  const Rgb radiance = radiance_at(scene, light.instance, light.triangle, b);
  if (is_black(radiance)) return std::nullopt;
  return LightSample{w, r, radiance / pdf, pdf, false, point, light.ng, light.reach_m};
}

float pdf_solid_angle(const TriangleLight& light, const V3f& p, const V2f& b) {
  const V3f d = light.vertex + light.edge1 * b.x + light.edge2 * b.y - p;
  const float r2 = d.dot(d);
  if (!(r2 > 0)) return 0;
  const float pdf = area_to_solid_angle(light, d / std::sqrt(r2), r2);
  return std::isfinite(pdf) ? pdf : 0.0F;
}

}  // namespace ivory
