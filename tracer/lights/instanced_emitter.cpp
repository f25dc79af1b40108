#include "tracer/lights/instanced_emitter.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace ivory {

namespace {

// Normal of the mesh's own triangle, its length the area.
V3d area_vector(const Mesh& mesh, int triangle) {
  const auto& corners = mesh.triangles[std::size_t(triangle)];
  const V3d a(mesh.positions[corners.x]);
  return (V3d(mesh.positions[corners.y]) - a).cross(V3d(mesh.positions[corners.z]) - a) * 0.5;
}

V3d row(const M44f& m, int i) { return {double(m[i][0]), double(m[i][1]), double(m[i][2])}; }

}  // namespace

InstancedEmitter make_instanced_emitter(const Scene& scene, const MeshEmission& emission) {
  const Mesh& mesh = scene.meshes[std::size_t(emission.mesh)];
  InstancedEmitter emitter;
  emitter.emission = &emission;
  emitter.entry.assign(mesh.triangles.size(), no_index);
  std::vector<double> powers;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Rgb& radiance = emission.mean_radiance[t];
    const V3d area = area_vector(mesh, int(t));
    const double length = area.length();
    if (!(length > 0) || is_black(radiance)) continue;
    emitter.entry[t] = int(emitter.triangles.size());
    emitter.triangles.push_back(int(t));
    powers.push_back(double(max_component(radiance)) * length);
    emitter.facings.push_back(
        {area / length, V3d(double(radiance.x), double(radiance.y), double(radiance.z)) * length});
  }
  emitter.table = AliasTable(powers);
  for (const double p : emitter.table.probabilities()) emitter.probability.push_back(float(p));

  // Flat lamps and boxes have few normals.
  auto& facings = emitter.facings;
  const auto key = [](const InstancedEmitter::Facing& f) { return std::tie(f.normal.x, f.normal.y, f.normal.z); };
  std::ranges::sort(facings, {}, key);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < facings.size(); ++i) {
    if (kept > 0 && key(facings[kept - 1]) == key(facings[i])) {
      facings[kept - 1].nits_m2 += facings[i].nits_m2;
    } else {
      facings[kept++] = facings[i];
    }
  }
  facings.resize(kept);
  facings.shrink_to_fit();
  for (const InstancedEmitter::Facing& f : facings) emitter.nits_m2 += f.nits_m2;
  return emitter;
}

// An area vector transforms by the cofactor matrix.
Rgb power_lm(const Scene& scene, const InstancedEmitter& emitter, int instance) {
  const M44f& m = scene.instances[std::size_t(instance)].to_world;
  const V3d x = row(m, 0);
  const V3d y = row(m, 1);
  const V3d z = row(m, 2);
  const V3d yz = y.cross(z);
  const V3d zx = z.cross(x);
  const V3d xy = x.cross(y);
  // Turned, mirrored and scaled alike all round, all areas grow by the same: most instances.
  const double scale = x.dot(x);
  const double most = 1e-6 * scale;
  const bool alike = std::abs(y.dot(y) - scale) < most && std::abs(z.dot(z) - scale) < most &&
                     std::abs(x.dot(y)) < most && std::abs(y.dot(z)) < most && std::abs(z.dot(x)) < most;
  V3d sum = emitter.nits_m2 * scale;
  if (!alike) {
    sum = V3d(0, 0, 0);
    for (const InstancedEmitter::Facing& f : emitter.facings)
      sum += f.nits_m2 * (yz * f.normal.x + zx * f.normal.y + xy * f.normal.z).length();
  }
  const Mesh& mesh = scene.meshes[std::size_t(emitter.emission->mesh)];
  const bool double_sided = scene.materials[std::size_t(mesh.material)].double_sided;
  sum *= double(pi) * (double_sided ? 2 : 1);
  return {float(sum.x), float(sum.y), float(sum.z)};
}

PickedTriangle pick(const Scene& scene, const InstancedEmitter& emitter, int instance, RandomStream& random) {
  const std::size_t entry = emitter.table.sample(random);
  return {make_triangle_light(scene, *emitter.emission, instance, emitter.triangles[entry]),
          emitter.probability[entry]};
}

}  // namespace ivory
