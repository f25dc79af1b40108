// All triangles of a scene, to compare scenes that should look the same.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "tracer/core/scene.h"

namespace ivory {

// A triangle as its corners in world space, starting with the smallest: equal for equal triangles
// of equal winding.
using Corners = std::array<std::array<float, 3>, 3>;

inline std::vector<Corners> world_triangles(const Scene& scene) {
  std::vector<Corners> result;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    for (const auto& t : mesh.triangles) {
      Corners corners;
      for (std::size_t c = 0; c < 3; ++c) {
        const V3f p = mesh.positions[t[int(c)]] * instance.to_world;
        corners[c] = {p.x, p.y, p.z};
      }
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      result.push_back(corners);
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace ivory
