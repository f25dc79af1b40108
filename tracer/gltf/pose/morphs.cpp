#include "tracer/gltf/pose/morphs.h"

#include <cmath>

namespace ivory::gltf {
namespace {

void check_counts(const Document& document, const Attributes& attributes) {
  const auto& targets = attributes.primitive.targets;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    for (const auto& [name, accessor] : targets[t]) {
      if (document.model.accessors[std::size_t(accessor)].count != attributes.accessor("POSITION").count) {
        document.fail(fmt::format("{} has {} of target {} for another number of vertices", attributes.what, name, t),
                      remedy);
      }
    }
  }
}

}  // namespace

// glTF 2.0, 3.7.2.2: base + sum of weights times displacements.
void apply_morphs(Document& document, const Attributes& attributes, std::span<const double> weights, Mesh& mesh) {
  check_counts(document, attributes);
  const auto& targets = attributes.primitive.targets;
  bool others = false;
  for (std::size_t t = 0; t < targets.size() && t < weights.size(); ++t) {
    const float weight = float(weights[t]);
    if (weight == 0) continue;
    const auto displace = [&](const char* name, auto& base) {
      const auto found = targets[t].find(name);
      if (found == targets[t].end() || base.empty()) return;
      const std::vector<V3f> delta = read_vec3(
          document, found->second, fmt::format("{} target {} {}", attributes.what, t, name), attributes.range);
      for (std::size_t i = 0; i < delta.size(); ++i) {
        base[i].x += weight * delta[i].x;
        base[i].y += weight * delta[i].y;
        base[i].z += weight * delta[i].z;
        if (!(std::isfinite(base[i].x) && std::isfinite(base[i].y) && std::isfinite(base[i].z))) {
          document.fail(fmt::format("{} has a {} that target {} by {} moves out of all bounds", attributes.what, name,
                                    t, weights[t]),
                        remedy);
        }
      }
    };
    displace("POSITION", mesh.positions);
    displace("NORMAL", mesh.normals);
    displace("TANGENT", mesh.tangents);
    for (const auto& [name, accessor] : targets[t])
      others |= name != "POSITION" && name != "NORMAL" && name != "TANGENT";
  }
  if (others)
    document.warn(attributes.what + " morphs colours or texture coordinates, which are taken as they are unmorphed");
}

}  // namespace ivory::gltf
