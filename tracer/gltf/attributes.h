// The vertex attributes of a primitive, wherever they are stored. Private to the loader.
#pragma once

#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tracer/gltf/accessors.h"
#include "tracer/gltf/draco.h"

namespace ivory::gltf {

// Where a primitive's attributes come from: accessors, or its Draco data.
struct Attributes {
  const Document& document;
  const tinygltf::Primitive& primitive;
  std::optional<DracoMesh> draco;
  std::string what;
  // The vertices that the triangles span: many files keep all primitives in one long array.
  Range range{};

  bool has(const std::string& name) const { return primitive.attributes.contains(name); }
  const tinygltf::Accessor& accessor(const std::string& name) const {
    return document.model.accessors[std::size_t(primitive.attributes.at(name))];
  }

  // One a vertex of `range`. Throws Error where there are not as many as positions, and as the accessors' readers do.
  template <class Vector, int n>
  std::vector<Vector> read(const std::string& name) const {
    const std::string user = what + " " + name;
    const std::size_t vertices = accessor("POSITION").count;
    if (accessor(name).count != vertices)
      document.fail(fmt::format("{} of {} vertices but POSITION of {}", user, accessor(name).count, vertices), remedy);
    if (draco && draco->has(name)) {
      const std::vector<float> floats = draco->floats(document, name, n);
      std::vector<Vector> result(floats.size() / n);
      if (!floats.empty()) std::memcpy(static_cast<void*>(result.data()), floats.data(), floats.size() * sizeof(float));
      return result;
    }
    const int index = primitive.attributes.at(name);
    if constexpr (n == 2) return read_vec2(document, index, user, range);
    if constexpr (n == 3) return read_vec3(document, index, user, range);
    if constexpr (n == 4) return read_vec4(document, index, user, range);
  }
};

}  // namespace ivory::gltf
