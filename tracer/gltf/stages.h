// The stages of load_gltf(), for who takes a file more than once. Private to the loader.
#pragma once

#include <string>

#include "tracer/core/scene.h"
#include "tracer/gltf/document.h"
#include "tracer/gltf/loader.h"

namespace ivory::gltf {

// Reads and checks the file; its nodes stand as they are stored. Throws as load_gltf() does.
void open_document(Document& document, const std::string& path, const LoadParams& params);

// The scene with the nodes where the document has them now, without name, hash and images, and which of its materials'
// images the file shows. Throws as load_gltf() does.
struct BuiltScene {
  Scene scene;
  std::vector<char> material_used;
};
BuiltScene build_scene(Document& document, const LoadParams& params);

}  // namespace ivory::gltf
