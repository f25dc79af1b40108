// Materials and textures. Private to the loader.
#pragma once

#include "tracer/core/scene.h"
#include "tracer/gltf/document.h"

namespace ivory::gltf {

// All materials of the file in its order, and one default material behind them.
std::vector<Material> make_materials(Document& document);

// KHR_materials_unlit: one colour whatever light falls on it. False for no_index.
bool is_unlit(const Document& document, int material);

// All textures of the file in its order; `image` is an index into the file's images.
std::vector<Texture> make_textures(Document& document);

}  // namespace ivory::gltf
