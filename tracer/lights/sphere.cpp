#include "tracer/lights/sphere.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "grid/base/error.h"

namespace ivory {

namespace {

// An icosahedron with each triangle split in four `times` times; vertices on the unit sphere.
Mesh make_geodesic_sphere(int times) {
  const float g = 0.5F * (1 + std::sqrt(5.0F));
  Mesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (V3f& p : mesh.positions) p.normalize();
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int i = 0; i < times; ++i) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, added] = middles.try_emplace(std::minmax(a, b), std::uint32_t(mesh.positions.size()));
      if (added) mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]).normalized());
      return found->second;
    };
    std::vector<Imath::Vec3<std::uint32_t>> finer;
    for (const auto& t : mesh.triangles) {
      const std::uint32_t ab = middle(t.x, t.y);
      const std::uint32_t bc = middle(t.y, t.z);
      const std::uint32_t ca = middle(t.z, t.x);
      finer.insert(finer.end(), {{t.x, ab, ca}, {t.y, bc, ab}, {t.z, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

double surface_area(const Mesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const V3d a(mesh.positions[t.x]);
    area += 0.5 * (V3d(mesh.positions[t.y]) - a).cross(V3d(mesh.positions[t.z]) - a).length();
  }
  return area;
}

bool finite(const V3f& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

void add_sphere_light(Scene& scene, const SphereLight& light, const std::string& source) {
  const Rgb& l = light.radiance_nits;
  if (!finite(light.center) || !std::isfinite(light.radius_m) || !(light.radius_m > 0) || !finite(l) || l.x < 0 ||
      l.y < 0 || l.z < 0) {
    throw Error(source, "has a spherical light that is not finite, without radius or with negative radiance",
                "give position and radius in metres and radiance in nits");
  }
  const float far_out = std::max({std::abs(light.center.x), std::abs(light.center.y), std::abs(light.center.z)});
  // Triangles are a fortieth of the radius wide; they need some ten steps of float.
  if (light.radius_m < 1e-7F * 400 * far_out || light.radius_m < 1e-6F || light.radius_m > 1e9F) {
    throw Error(source, "has a spherical light too small or too large for its distance from the origin",
                "move or scale the scene");
  }
  scene.sphere_lights.push_back(light);
  scene.sphere_lights.back().instance = int(scene.instances.size());

  static const Mesh unit = [] {
    Mesh mesh = make_geodesic_sphere(4);
    const auto scale = float(std::sqrt(4 * double(pi) / surface_area(mesh)));
    for (V3f& p : mesh.positions) p *= scale;
    return mesh;
  }();
  Material material;
  material.name = "spherical light";
  material.base_color = Rgb(0, 0, 0);
  material.metallic = 0;
  material.specular = 0;
  material.emission = l;
  Mesh mesh = unit;
  mesh.name = material.name;
  mesh.material = int(scene.materials.size());
  for (V3f& p : mesh.positions) p = light.center + p * light.radius_m;
  scene.materials.push_back(material);
  scene.instances.push_back({int(scene.meshes.size()), M44f()});
  scene.meshes.push_back(std::move(mesh));
}

}  // namespace ivory
