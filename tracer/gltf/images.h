// Images of a file to texels. Private to the loader.
#pragma once

#include "tracer/core/scene.h"
#include "tracer/gltf/document.h"

namespace ivory::gltf {

// Decodes the images that the materials use (those of which `material_used` is set) into
// scene.images, and makes scene.textures point there.
void load_images(Document& document, const std::vector<char>& material_used, Scene& scene);

// PNG, JPEG or WebP. Returns why it cannot be decoded; empty when it could.
std::string decode_image(std::span<const std::uint8_t> bytes, Image& image);

}  // namespace ivory::gltf
