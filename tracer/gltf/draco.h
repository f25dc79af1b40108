// KHR_draco_mesh_compression. Private to the loader.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tracer/gltf/document.h"

namespace ivory::gltf {

// A decoded Draco mesh: its triangles, and its attributes by their glTF names.
class DracoMesh {
 public:
  // Decodes the primitive's extension object. Throws Error for damaged data, data that claim more
  // than they can hold, or attributes that the data lack.
  DracoMesh(const Document& document, const nlohmann::json& extension, const tinygltf::Primitive& primitive,
            const std::string& what);
  ~DracoMesh();
  DracoMesh(DracoMesh&&) noexcept;
  DracoMesh& operator=(DracoMesh&&) noexcept;

  std::size_t vertex_count() const;
  std::vector<std::uint32_t> indices() const;
  bool has(const std::string& attribute) const;
  // `components` floats a vertex. Throws Error where the attribute has another number of components
  // or a value that is not finite.
  std::vector<float> floats(const Document& document, const std::string& attribute, int components) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ivory::gltf
