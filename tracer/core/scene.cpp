#include "tracer/core/scene.h"

namespace ivory {

bool transmits(const Material& material) { return material.transmission > 0 && is_black(material.emission); }

bool has_coverage(const Material& material) { return material.alpha_mode != AlphaMode::opaque || transmits(material); }

Box3f bounds(const Scene& scene) {
  Box3f box;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    // Only vertices that a triangle uses: files carry stray ones.
    for (const auto& triangle : mesh.triangles) {
      for (int corner = 0; corner < 3; ++corner) box.extendBy(mesh.positions[triangle[corner]] * instance.to_world);
    }
  }
  return box;
}

}  // namespace ivory
